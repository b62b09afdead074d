// What kernels share: vectors, particles in their buffers, rows of the neighbour list, the run's status.

DEVICE Vec3 vector(const Quad q)                     { Vec3 v; v.x = q.x; v.y = q.y; v.z = q.z; return v; }
DEVICE Vec3 zero(void)                               { Vec3 v; v.x = 0.0; v.y = 0.0; v.z = 0.0; return v; }
DEVICE Quad quad(const Vec3 v, const real w)         { return QUAD(v.x, v.y, v.z, w); }
DEVICE Vec3 plus(const Vec3 a, const Vec3 b)         { Vec3 v; v.x = a.x + b.x; v.y = a.y + b.y; v.z = a.z + b.z; return v; }
DEVICE Vec3 minus(const Vec3 a, const Vec3 b)        { Vec3 v; v.x = a.x - b.x; v.y = a.y - b.y; v.z = a.z - b.z; return v; }
DEVICE Vec3 times(const Vec3 a, const real s)        { Vec3 v; v.x = a.x * s; v.y = a.y * s; v.z = a.z * s; return v; }
DEVICE real inner(const Vec3 a, const Vec3 b)        { return a.x * b.x + a.y * b.y + a.z * b.z; }

DEVICE Sphere sphere(const Quad place, const Quad motion, const Quad spin)
{
    Sphere s;
    s.position = vector(place);
    s.radius = place.w;
    s.velocity = vector(motion);
    s.mass = motion.w;
    s.angular_velocity = vector(spin);
    return s;
}

// From one centre to the other, the shortest way.
DEVICE Vec3 offset_between(const Step step, const Vec3 from, const Vec3 to)
{
    const Vec3 offset = minus(to, from);
#if PERIODIC
    Vec3 nearest;
    nearest_image(step.period, offset, &nearest);
    return nearest;
#else
    return offset;
#endif
}

// Rows stand side by side in slices of SLICE particles, so that neighbouring work-items read neighbouring words. A slot
// holds the other particle, or the number of particles plus the index of a wall, or NOBODY behind the last. A bit says
// that a pair touches, another that its bond keeps contact off.
#define SLICE     32u
#define TOUCHING  0x80000000u
#define BONDED    0x40000000u
#define NOBODY    0x3fffffffu
#define SLOT(k, i)                ((size_t)(k) * SLICE + (i) % SLICE)
#define DISPLACEMENT(k, c, i)     (((size_t)(k) * 3u + (c)) * SLICE + (i) % SLICE)

DEVICE Vec3 displacement_at(GLOBAL const real *RESTRICT displacement, const u32 k, const u32 i)
{
    Vec3 v;
    v.x = displacement[DISPLACEMENT(k, 0, i)];
    v.y = displacement[DISPLACEMENT(k, 1, i)];
    v.z = displacement[DISPLACEMENT(k, 2, i)];
    return v;
}

DEVICE void keep_displacement(GLOBAL real *RESTRICT displacement, const u32 k, const u32 i, const Vec3 v)
{
    displacement[DISPLACEMENT(k, 0, i)] = v.x;
    displacement[DISPLACEMENT(k, 1, i)] = v.y;
    displacement[DISPLACEMENT(k, 2, i)] = v.z;
}

// A row's displacements are read once per step, far from each other: the next is asked for while one is worked on.
DEVICE void will_read_displacement(GLOBAL const real *RESTRICT displacement, const u32 k, const u32 i)
{
    WILL_READ(displacement + DISPLACEMENT(k, 0, i));
    WILL_READ(displacement + DISPLACEMENT(k, 1, i));
    WILL_READ(displacement + DISPLACEMENT(k, 2, i));
}

// Where a particle was when its list was made: its coordinates in ticks, each modulo 2^21, in one word. A list lasts while
// ways are short, and of a short way the last bits tell all.
#define TICK_BITS  21u
#define TICK_MASK  0x1fffffu

DEVICE u64 ticks_of(const Vec3 x, const Vec3 origin, const real per_metre)
{
    const u64 a = (u64)(i64)((x.x - origin.x) * per_metre) & TICK_MASK;
    const u64 b = (u64)(i64)((x.y - origin.y) * per_metre) & TICK_MASK;
    const u64 c = (u64)(i64)((x.z - origin.z) * per_metre) & TICK_MASK;
    return a | b << TICK_BITS | c << 2u * TICK_BITS;
}

// The squared way from one to the other, in ticks, short of 2^20 along each direction.
DEVICE u64 squared_ticks(const u64 from, const u64 to)
{
    u64 sum = 0;
    for (u32 k = 0; k < 3u; ++k) {
        const u32 turned = ((u32)(to >> k * TICK_BITS) - (u32)(from >> k * TICK_BITS)) << (32u - TICK_BITS);
        const i64 way = (i32)turned >> (32u - TICK_BITS);
        sum += (u64)(way * way);
    }
    return sum;
}

// The status of the run. A kernel reads the flags that the one before it left and raises its own for the next; while any
// flag is up, nothing is computed, and the host decides.
#define FLAGS(parity)  (parity)
#define DONE           2
#define FARTHEST_STEP  3
#define LIST_DUE       1u
#define ASTRAY         2u
#define CRUSHED        4u
#define UNPHYSICAL     8u

DEVICE void raise_flags(const Step step, GLOBAL u32 *status, const u32 flags)
{
    GLOBAL u32 *next = status + FLAGS(1u - step.parity);
    if ((*next & flags) != flags)
        ATOMIC_OR(next, flags);
}

DEVICE u32 halted(const Step step, GLOBAL u32 *status)
{
    return status[FLAGS(step.parity)];
}

// The first work-item hands flags on, or counts the step.
DEVICE void hand_on(const Step step, GLOBAL u32 *status, const u32 flags, const u32 steps)
{
    if (GROUP_INDEX == 0u && LOCAL_INDEX == 0u) {
        if (flags)
            raise_flags(step, status, flags);
        else
            status[DONE] += steps;
    }
}

#define CONSTRAINT_OF(kind)  (((kind) >> 16) & 0x7fffu)
// Whether both particles of a pair stay where they are.
#if CONSTRAINED
#define BOTH_HELD(kind, i, j)  ((kind)[i] & (kind)[j] & 0x80000000u)
#else
#define BOTH_HELD(kind, i, j)  0
#endif
#define MATERIAL_OF(kind)    ((kind) & 0xffffu)

// Puts prescribed components in the place of computed ones.
DEVICE Vec3 prescribe(const Vec3 computed, const Vec3 given, const u32 held)
{
    Vec3 v = computed;
    if (held & 1u) v.x = given.x;
    if (held & 2u) v.y = given.y;
    if (held & 4u) v.z = given.z;
    return v;
}
