#version 460
#extension GL_EXT_ray_tracing : require

/* Never run: occlusion rays skip it. */
void main() {}
