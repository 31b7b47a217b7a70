/* What a ray for the nearest hit brings back. */
struct nearest_hit {
    uint triangle; /* gl_PrimitiveID; 0xffffffff: none */
    uint entry;    /* of the TLAS */
    float u;       /* barycentric, of the second and the third corner */
    float v;
    float t; /* along the ray, in its lengths */
};
