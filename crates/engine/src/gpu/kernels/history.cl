// What touching pairs remember, put aside in the order of the particles before they are put in a new one. Each pair
// stands once, with its lower rank, and names the higher one; a wall stands behind all ranks.

// Whether the row's particle keeps this slot, and under which number.
DEVICE u32 partner_kept(const u32 particles, const u32 entry, const u32 mine, GLOBAL const u32 *RESTRICT rank)
{
    const u32 j = entry & ~TOUCHING;
    if (!(entry & TOUCHING) || j == NOBODY)
        return NOBODY;
    if (j >= particles)
        return j;
    return rank[j] > mine ? rank[j] : NOBODY;
}

kernel history_count
{
    FOR_EACH(i, particles) {
        const u32 mine = rank[i];
        u32 kept = 0;
        for (u32 k = slice[i / SLICE]; k < slice[i / SLICE + 1u]; ++k)
            if (partner_kept(particles, other[SLOT(k, i)], mine, rank) != NOBODY)
                ++kept;
        counts[i] = kept;
    }
}

kernel history_write
{
    FOR_EACH(i, particles) {
        const u32 mine = rank[i];
        u32 at = starts[i];
        for (u32 k = slice[i / SLICE]; k < slice[i / SLICE + 1u]; ++k) {
            const u32 partner = partner_kept(particles, other[SLOT(k, i)], mine, rank);
            if (partner != NOBODY) {
                partners[at] = partner;
#if FRICTION
                const Vec3 kept = displacement_at(displacement, k, i);
                remembered[3u * (size_t)at] = kept.x;
                remembered[3u * (size_t)at + 1u] = kept.y;
                remembered[3u * (size_t)at + 2u] = kept.z;
#endif
                ++at;
            }
        }
    }
}
