// What moves, loaded, kicked and kept: for the stages that look at one particle at a time.

// What moves: a sphere and, under Gear, its scaled second to fifth derivatives.
typedef struct {
    Sphere sphere;
#if GEAR
    Vec3 derivatives[4];
#endif
} Body;

DEVICE Body body_at(const Step step, const u32 i, const Quad place, const Quad motion, const Quad spin,
                    GLOBAL const real *derivatives)
{
    Body body;
    body.sphere = sphere(place, motion, spin);
#if GEAR
    for (u32 d = 0; d < 4u; ++d)
        body.derivatives[d] = planes_at(step, derivatives, 3u * d, i);
#endif
    return body;
}

// Everything but the place, which is still looked at.
DEVICE void keep_motion(const Step step, const u32 i, const Body body, GLOBAL Quad *motion, GLOBAL Quad *spin,
                        GLOBAL real *derivatives)
{
    motion[i] = quad(body.sphere.velocity, body.sphere.mass);
#if MOMENTS
    spin[i] = quad(body.sphere.angular_velocity, 0.0);
#endif
#if GEAR
    for (u32 d = 0; d < 4u; ++d)
        set_planes(step, derivatives, 3u * d, i, body.derivatives[d]);
#endif
}

#if CONSTRAINED
#define HELD(kind)  constraints[CONSTRAINT_OF(kind)]
#else
#define HELD(kind)  free_of_constraints()
#endif

DEVICE Constraint free_of_constraints(void)
{
    Constraint held;
    held.components = 0u;
    return held;
}

DEVICE void kick_velocity(Sphere *body, const Vec3 force, const Constraint held, const real dt)
{
    Vec3 kicked;
    kick(body->velocity, force, body->mass, dt, &kicked);
#if CONSTRAINED
    kicked = prescribe(kicked, held.velocity, held.components);
#endif
    body->velocity = kicked;
}

DEVICE void kick_angular_velocity(Sphere *body, const Vec3 moment, const Constraint held, const real dt)
{
#if MOMENTS
    real inertia;
    sphere_inertia(body->mass, body->radius, &inertia);
    Vec3 kicked;
    kick(body->angular_velocity, moment, inertia, dt, &kicked);
#if CONSTRAINED
    kicked = prescribe(kicked, held.angular_velocity, held.components >> 3);
#endif
    body->angular_velocity = kicked;
#endif
}

#if MOMENTS
#define SPIN(i)    spin[i]
#define MOMENT(i)  vector(moment[i])
#else
#define SPIN(i)    QUAD(0.0, 0.0, 0.0, 0.0)
#define MOMENT(i)  zero()
#endif
