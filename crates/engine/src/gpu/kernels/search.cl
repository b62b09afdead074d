// Stage `search`: cells, the order of the particles, the neighbour list.

// Partial bounds of all centres and radii, one pair of corners per group.
kernel bounds
{
    LOCAL Quad lowest[128];
    LOCAL Quad highest[128];
    const u32 lane = LOCAL_INDEX;
    Quad low = QUAD(INFINITY, INFINITY, INFINITY, INFINITY), high = QUAD(-INFINITY, -INFINITY, -INFINITY, 0.0);
    for (u32 i = GROUP_INDEX * 128u + lane; i < particles; i += GROUP_COUNT * 128u) {
        const Quad x = place[i];
        low.x = x.x < low.x ? x.x : low.x;
        low.y = x.y < low.y ? x.y : low.y;
        low.z = x.z < low.z ? x.z : low.z;
        low.w = x.w < low.w ? x.w : low.w;
        high.x = x.x > high.x ? x.x : high.x;
        high.y = x.y > high.y ? x.y : high.y;
        high.z = x.z > high.z ? x.z : high.z;
        high.w = x.w > high.w ? x.w : high.w;
    }
    lowest[lane] = low;
    highest[lane] = high;
    BARRIER;
    for (u32 reach = 64u; reach > 0u; reach /= 2u) {
        if (lane < reach) {
            const Quad a = lowest[lane + reach], b = highest[lane + reach];
            low.x = a.x < low.x ? a.x : low.x;
            low.y = a.y < low.y ? a.y : low.y;
            low.z = a.z < low.z ? a.z : low.z;
            low.w = a.w < low.w ? a.w : low.w;
            high.x = b.x > high.x ? b.x : high.x;
            high.y = b.y > high.y ? b.y : high.y;
            high.z = b.z > high.z ? b.z : high.z;
            high.w = b.w > high.w ? b.w : high.w;
            lowest[lane] = low;
            highest[lane] = high;
        }
        BARRIER;
    }
    if (lane == 0u) {
        corners[2u * GROUP_INDEX] = low;
        corners[2u * GROUP_INDEX + 1u] = high;
    }
}

// Size classes, each half as large as the one before.
DEVICE u32 class_of(const real radius, const real largest)
{
    u32 class_index = 0;
    real bound = 0.5 * largest;
    while (radius <= bound && class_index < 30u) {
        ++class_index;
        bound *= 0.5;
    }
    return class_index;
}

// A coordinate in cells, inside the box whatever it is, even if it is not a number.
DEVICE u32 cell_along(const real coordinate, const real low, const real per_metre, const u32 along)
{
    real c = (coordinate - low) * per_metre;
    c = c > 0.0 ? c : 0.0;
    const real last = (real)(along - 1u);
    return (u32)(c < last ? c : last);
}

// Cells are numbered in strips: row after row along x, some rows side by side in y, then the next layer in z, and when a
// strip is done the next strip. Particles stand in this order, so that neighbours in space are near in memory.
DEVICE u32 cell_number(const Level level, const u32 x, const u32 y, const u32 z)
{
    return level.first_cell + ((y / level.strip * level.cells_z + z) * level.strip + y % level.strip) * level.cells_x + x;
}

kernel cells
{
    FOR_EACH(i, search.particles) {
        const Quad x = place[i];
        const Level level = levels[search.levels > 1u ? class_of(x.w, search.largest) : 0u];
        const u32 cell_x = cell_along(x.x, level.min.x, level.per_metre.x, level.along_x);
        const u32 cell_y = cell_along(x.y, level.min.y, level.per_metre.y, level.along_y);
        const u32 cell_z = cell_along(x.z, level.min.z, level.per_metre.z, level.along_z);
        const u32 cell = cell_number(level, cell_x % level.cells_x, cell_y % level.cells_y, cell_z % level.cells_z);
        cell_of[i] = cell;
        place_in_cell[i] = ATOMIC_ADD(cell_count + cell, 1u);
    }
}

kernel order_cells
{
    FOR_EACH(i, particles) {
        order[cell_start[cell_of[i]] + place_in_cell[i]] = i;
    }
}

// Inside a cell particles stand in the order of ranks, whichever came first.
kernel order_ranks
{
    FOR_EACH(c, cell_total) {
        const u32 start = cell_start[c], end = cell_start[c + 1u];
        for (u32 at = start + 1u; at < end; ++at) {
            const u32 item = order[at];
            const u32 key = rank[item];
            u32 to = at;
            while (to > start && rank[order[to - 1u]] > key) {
                order[to] = order[to - 1u];
                --to;
            }
            order[to] = item;
        }
    }
}

kernel take_quads
{
    FOR_EACH(i, particles) {
        to[i] = from[order[i]];
    }
}

#if HEAT
kernel take_reals
{
    FOR_EACH(i, particles) {
        to[i] = from[order[i]];
    }
}
#endif

kernel take_words
{
    FOR_EACH(i, particles) {
        to[i] = from[order[i]];
    }
}

kernel take_images
{
    FOR_EACH(i, particles) {
        const u32 source = order[i];
        for (u32 c = 0; c < 3u; ++c)
            to[(size_t)c * particles + i] = from[(size_t)c * particles + source];
    }
}

DEVICE int near(const Search search, const Quad a, const Quad b)
{
    Vec3 offset = minus(vector(b), vector(a));
#if PERIODIC
    Vec3 nearest;
    nearest_image(search.period, offset, &nearest);
    offset = nearest;
#endif
    const real reach = a.w + b.w + search.skin;
    return inner(offset, offset) < reach * reach;
}

DEVICE int near_wall(const Search search, const Quad x, const Wall wall, const Quad point)
{
    Touch touch;
    touch_of_wall(vector(x), x.w, vector(point), wall.normal, &touch);
    return touch.overlap > -search.skin;
}

// The cells within reach along one direction: the first, and how many; they may go round where the box repeats or is
// folded.
DEVICE i32 first_within(const real coordinate, const real reach, const real low, const real per_metre, const u32 along,
                        const u32 cells, const u32 wraps, u32 *many)
{
    if (!wraps) {
        const u32 from = cell_along(coordinate - reach, low, per_metre, along);
        const u32 count = cell_along(coordinate + reach, low, per_metre, along) - from + 1u;
        *many = count < cells ? count : cells;
        return count < cells ? (i32)(from % cells) : 0;
    }
    real a = (coordinate - reach - low) * per_metre;
    real b = (coordinate + reach - low) * per_metre;
    // Towards minus infinity: a cast goes towards zero. A particle is inside its box, and so is its reach up to one box.
    const i32 shift = (i32)cells;
    const real room = (real)shift;
    a = a > -room ? a : -room;
    b = b < 2.0 * room ? b : 2.0 * room;
    const i32 from = (i32)(a + room) - shift, to = (i32)(b + room) - shift;
    if (to - from + 1 >= (i32)cells) {
        *many = cells;
        return 0;
    }
    *many = (u32)(to - from + 1);
    return from;
}

DEVICE u32 wrapped(const i32 cell, const u32 cells)
{
    return (u32)(cell < 0 ? cell + (i32)cells : cell >= (i32)cells ? cell - (i32)cells : cell);
}

// The walk over all candidates of a particle: RUN(first, stop) is expanded for each run of particles in cells side by
// side along x.
#define AROUND(RUN)                                                                                                    \
    for (u32 l = 0; l < search.levels; ++l) {                                                                          \
        const Level level = levels[l];                                                                                 \
        const real reach = 1.0000001 * (x.w + level.largest + search.skin);                                            \
        u32 many_x, many_y, many_z;                                                                                    \
        const i32 from_x = first_within(x.x, reach, level.min.x, level.per_metre.x, level.along_x,                     \
                                        level.cells_x, search.wraps & 1u, &many_x);                                    \
        const i32 from_y = first_within(x.y, reach, level.min.y, level.per_metre.y, level.along_y,                     \
                                        level.cells_y, search.wraps & 2u, &many_y);                                    \
        const i32 from_z = first_within(x.z, reach, level.min.z, level.per_metre.z, level.along_z,                     \
                                        level.cells_z, search.wraps & 4u, &many_z);                                    \
        for (u32 cz = 0; cz < many_z; ++cz)                                                                            \
            for (u32 cy = 0; cy < many_y; ++cy) {                                                                      \
                const u32 row = cell_number(level, 0, wrapped(from_y + (i32)cy, level.cells_y),                        \
                                            wrapped(from_z + (i32)cz, level.cells_z));                                 \
                for (u32 cx = 0; cx < many_x;) {                                                                       \
                    /* At the seam of a direction that repeats, a run ends. */                                         \
                    const u32 cell = wrapped(from_x + (i32)cx, level.cells_x);                                         \
                    const u32 left = many_x - cx, room = level.cells_x - cell;                                         \
                    const u32 run = left < room ? left : room;                                                         \
                    RUN(cell_start[row + cell], cell_start[row + cell + run])                                          \
                    cx += run;                                                                                         \
                }                                                                                                      \
            }                                                                                                          \
    }

// `order` says where particles stood before they were put in the order of cells, or, if they were left where they are,
// which stands where in that order.
#define CANDIDATE(at)  (search.reordered ? (at) : order[at])
#define BEFORE(i)      (search.reordered ? order[i] : (i))

// The length of each slice is that of its longest row. Which of the candidates are neighbours is noted, a bit for each,
// and above the bits how many of them have a higher rank; a particle with more candidates than bits is looked at again
// when rows are filled.
#define CANDIDATES  56u
#define LOOK_AGAIN  0xffffffffu

kernel rows_count
{
    LOCAL u32 length[128];
    const u32 lane = LOCAL_INDEX;
    const u32 i = GROUP_INDEX * 128u + lane;
    u32 entries = 0;
    if (i < search.particles) {
        const Quad x = LOAD(place, i);
        const u32 mine = rank[i];
        u64 known = 0;
        u32 candidate = 0, higher = 0;
#define COUNT(first, stop)                                                                                             \
        for (u32 at = first, end = stop; at < end; ++at, ++candidate) {                                                \
            const u32 j = CANDIDATE(at);                                                                               \
            if (j != i && near(search, x, LOAD(place, j))) {                                                           \
                ++entries;                                                                                             \
                higher += rank[j] > mine ? 1u : 0u;                                                                    \
                if (candidate < CANDIDATES)                                                                            \
                    known |= (u64)1 << candidate;                                                                      \
            }                                                                                                          \
        }
        AROUND(COUNT)
        const u32 again = candidate > CANDIDATES;
        known_low[i] = again ? higher : (u32)known;
        known_high[i] = again ? LOOK_AGAIN : (u32)(known >> 32) | higher << (CANDIDATES - 32u);
        for (u32 w = 0; w < search.walls; ++w)
            if (near_wall(search, x, walls[w], wall_place[w]))
                ++entries;
    }
    length[lane] = entries;
    BARRIER;
    if (lane % SLICE == 0u && i < search.particles) {
        u32 longest = 0;
        for (u32 k = 0; k < SLICE; ++k)
            longest = length[lane + k] > longest ? length[lane + k] : longest;
        slice_length[i / SLICE] = longest;
    }
}

// One part of a row while it is filled: ascending ranks.
typedef struct {
    u32 first;
    u32 end;
    u32 highest;
} Part;

// Puts a neighbour where it belongs: mostly behind those before it.
DEVICE void insert(Part *part, const u32 j, const u32 key, const u32 i, GLOBAL u32 *RESTRICT other,
                   GLOBAL const u32 *RESTRICT rank)
{
    u32 to = part->end++;
    if (to == part->first || key > part->highest) {
        part->highest = key;
    } else {
        while (to > part->first && rank[other[SLOT(to - 1u, i)]] > key) {
            other[SLOT(to, i)] = other[SLOT(to - 1u, i)];
            --to;
        }
    }
    other[SLOT(to, i)] = j;
}

// Rows in their order, with what touching pairs remember.
kernel rows_fill
{
    FOR_EACH(i, search.items) {
        if (i < search.walls)
            wall_reference[i] = wall_place[i];
        if (i >= search.particles)
            continue;
        const Quad x = LOAD(place, i);
        const u32 mine = rank[i];
        const u32 start = slice[i / SLICE], end = slice[i / SLICE + 1u];
        const u32 again = known_high[i] == LOOK_AGAIN;
        const u64 known = (u64)known_low[i] | (u64)(known_high[i] & ((1u << (CANDIDATES - 32u)) - 1u)) << 32;
        // Higher ranks first, then lower ones.
        Part higher, lower;
        higher.first = higher.end = start;
        lower.first = lower.end = start + (again ? known_low[i] : known_high[i] >> (CANDIDATES - 32u));
        higher.highest = lower.highest = 0u;
        u32 candidate = 0;
#define INSERT(j)                                                                                                      \
        {                                                                                                              \
            const u32 theirs = rank[j];                                                                                \
            if (theirs > mine)                                                                                         \
                insert(&higher, j, theirs, i, other, rank);                                                            \
            else                                                                                                       \
                insert(&lower, j, theirs, i, other, rank);                                                             \
        }
#define FILL(first, stop)                                                                                              \
        {                                                                                                              \
            const u32 from = first, length = stop - from;                                                              \
            if (again) {                                                                                               \
                for (u32 at = from; at < from + length; ++at) {                                                        \
                    const u32 j = CANDIDATE(at);                                                                       \
                    if (j != i && near(search, x, LOAD(place, j)))                                                     \
                        INSERT(j)                                                                                      \
                }                                                                                                      \
            } else if (length > 0u) {                                                                                  \
                u64 bits = known >> candidate;                                                                         \
                if (length < CANDIDATES)                                                                               \
                    bits &= ((u64)1 << length) - 1u;                                                                   \
                for (; bits; bits &= bits - 1u) {                                                                      \
                    const u32 j = CANDIDATE(from + LOWEST_BIT(bits));                                                  \
                    INSERT(j)                                                                                          \
                }                                                                                                      \
                candidate += length;                                                                                   \
            }                                                                                                          \
        }
        AROUND(FILL)
        const u32 neighbours = lower.end;
        u32 last = neighbours;
        for (u32 w = 0; w < search.walls; ++w)
            if (near_wall(search, x, walls[w], wall_place[w])) {
                other[SLOT(last, i)] = search.particles + w;
                ++last;
            }
        // Mine stand in the order of my row; those of lower ranks are looked up at theirs, where they stood before.
        const u32 before = BEFORE(i);
        u32 at = search.histories ? starts[before] : 0u;
        const u32 stop = search.histories ? starts[before + 1u] : 0u;
        for (u32 k = start; search.histories && k < last; ++k) {
            const u32 j = other[SLOT(k, i)];
            const u32 partner = k < neighbours ? rank[j] : j;
            u32 found = NOBODY;
            real sign = 1.0;
            if (partner > mine) {
                if (at < stop && partners[at] == partner)
                    found = at++;
                else
                    for (u32 t = at; t < stop; ++t)
                        if (partners[t] == partner) {
                            found = t;
                            at = t + 1u;
                            break;
                        }
            } else {
                sign = -1.0;
                const u32 there = BEFORE(j);
                for (u32 t = starts[there]; t < starts[there + 1u]; ++t)
                    if (partners[t] == mine) {
                        found = t;
                        break;
                    }
            }
            if (found != NOBODY)
                other[SLOT(k, i)] = j | TOUCHING;
#if FRICTION
            // Slots without a history are written as well: memory takes whole sectors faster than what is left of them.
            Vec3 kept = zero();
            if (found != NOBODY) {
                kept.x = sign * remembered[3u * (size_t)found];
                kept.y = sign * remembered[3u * (size_t)found + 1u];
                kept.z = sign * remembered[3u * (size_t)found + 2u];
            }
            keep_displacement(displacement, k, i, kept);
#endif
        }
        for (u32 k = last; k < end; ++k)
            other[SLOT(k, i)] = NOBODY;
#if BONDS_KEEP_OFF
        for (u32 b = 0; b < search.bond_slots; ++b) {
            const u32 entry = bond_other[(size_t)b * search.particles + i];
            if (entry == NOBODY)
                break;
            for (u32 k = start; entry & HOLDS && k < neighbours; ++k)
                if (other[SLOT(k, i)] == (entry & ~HOLDS))
                    other[SLOT(k, i)] |= BONDED;
        }
#endif
        reference[i] = ticks_of(vector(x), search.origin, search.ticks_per_metre);
#if EXPANDS
        listed_radius[i] = x.w;
#endif
    }
}
