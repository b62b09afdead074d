// What moves, loaded, kicked and kept: for the stages that look at one particle at a time.

// What moves: a sphere and, under Gear, its scaled second to fifth derivatives.
typedef struct {
    Sphere sphere;
#if GEAR
    Vec3 derivatives[4];
#endif
#if BONDS
    Quaternion orientation;
#endif
#if HEAT
    real temperature;
#endif
} Body;

#if BONDS
DEVICE Quaternion quaternion(const Quad q)
{
    Quaternion orientation;
    orientation.vector = vector(q);
    orientation.scalar = q.w;
    return orientation;
}
#endif

// The derivatives of one coordinate stand together.
#if GEAR
#define DERIVATIVES  derivatives_x, derivatives_y, derivatives_z

DEVICE void derivatives_at(Body *body, const Quad x, const Quad y, const Quad z)
{
    Vec3 *d = body->derivatives;
    d[0].x = x.x; d[1].x = x.y; d[2].x = x.z; d[3].x = x.w;
    d[0].y = y.x; d[1].y = y.y; d[2].y = y.z; d[3].y = y.w;
    d[0].z = z.x; d[1].z = z.y; d[2].z = z.z; d[3].z = z.w;
}
#else
#define DERIVATIVES  0, 0, 0
#endif

DEVICE Body body_at(const u32 i, const Quad place, const Quad motion, const Quad spin, GLOBAL const Quad *derivatives_x,
                    GLOBAL const Quad *derivatives_y, GLOBAL const Quad *derivatives_z)
{
    Body body;
    body.sphere = sphere(place, motion, spin);
#if HEAT
    body.temperature = spin.w;
#endif
#if GEAR
    derivatives_at(&body, derivatives_x[i], derivatives_y[i], derivatives_z[i]);
#endif
    return body;
}

// Everything but the place, which is still looked at, and a temperature that stands apart.
DEVICE void keep_motion(const u32 i, const Body body, GLOBAL Quad *motion, GLOBAL Quad *spin, GLOBAL Quad *derivatives_x,
                        GLOBAL Quad *derivatives_y, GLOBAL Quad *derivatives_z)
{
    motion[i] = quad(body.sphere.velocity, body.sphere.mass);
#if MOMENTS
#if HEAT
    spin[i] = quad(body.sphere.angular_velocity, body.temperature);
#else
    spin[i] = quad(body.sphere.angular_velocity, 0.0);
#endif
#endif
#if GEAR
    const Vec3 *d = body.derivatives;
    derivatives_x[i] = QUAD(d[0].x, d[1].x, d[2].x, d[3].x);
    derivatives_y[i] = QUAD(d[0].y, d[1].y, d[2].y, d[3].y);
    derivatives_z[i] = QUAD(d[0].z, d[1].z, d[2].z, d[3].z);
#endif
}

// What a particle is ordered to do at a time.
#if CONSTRAINED
#define HELD(kind, time)  constraint_at(constraints[CONSTRAINT_OF(kind)], pieces, time)
#else
#define HELD(kind, time)  free_of_constraints()
#endif

DEVICE Constraint free_of_constraints(void)
{
    Constraint held;
    held.components = 0u;
    return held;
}

// Pieces of ramps replace the numbers of a constraint.
DEVICE Constraint constraint_at(const Constraint given, GLOBAL const Piece *RESTRICT pieces, const real time)
{
    Constraint held = given;
#if RAMPS
    for (u32 k = held.first_piece; k < held.end_piece; ++k) {
        const Piece piece = pieces[k];
        if (piece.from <= time && time < piece.until) {
            real value;
            ramp_line(piece.start, piece.start_value, piece.end, piece.end_value, time, &value);
            if (piece.number == 0u) held.velocity.x = value;
            if (piece.number == 1u) held.velocity.y = value;
            if (piece.number == 2u) held.velocity.z = value;
            if (piece.number == 3u) held.angular_velocity.x = value;
            if (piece.number == 4u) held.angular_velocity.y = value;
            if (piece.number == 5u) held.angular_velocity.z = value;
            if (piece.number == 6u) held.force.x = value;
            if (piece.number == 7u) held.force.y = value;
            if (piece.number == 8u) held.force.z = value;
        }
    }
#endif
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

#if ONE_PAIR
#define INTERACTION(first, second)  step.pair
#else
#define INTERACTION(first, second)  interactions[(first) * step.materials + (second)]
#endif

// Where all particles are alike, a partner is as large, or as heavy, as the particle itself: what follows from that is
// computed once for all partners.
#if ONE_RADIUS
#define RADIUS_OF_PARTNER(place)  body.radius
#else
#define RADIUS_OF_PARTNER(place)  (place).w
#endif
#if ONE_MASS
#define MASS_OF_PARTNER(motion)   body.mass
#else
#define MASS_OF_PARTNER(motion)   (motion).w
#endif
