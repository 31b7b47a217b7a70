#version 460
#extension GL_EXT_ray_tracing : require

/* Never run: these rays skip it. */
void main() {}
