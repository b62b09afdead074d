// Exclusive prefix sums in their own place, in three passes: inside blocks, over the blocks' sums, and both together.

#define SCAN_GROUP  256u
#define SCAN_ITEMS  4u

// Of `count` values; the entry behind the last gets the total.
kernel scan_blocks
{
    LOCAL u32 partial[SCAN_GROUP];
    const u32 lane = LOCAL_INDEX;
    const u32 first = (GROUP_INDEX * SCAN_GROUP + lane) * SCAN_ITEMS;
    u32 mine[SCAN_ITEMS];
    u32 sum = 0;
    for (u32 k = 0; k < SCAN_ITEMS; ++k) {
        mine[k] = first + k < count ? values[first + k] : 0u;
        sum += mine[k];
    }
    partial[lane] = sum;
    BARRIER;
    for (u32 reach = 1; reach < SCAN_GROUP; reach *= 2u) {
        const u32 before = lane >= reach ? partial[lane - reach] : 0u;
        BARRIER;
        partial[lane] += before;
        BARRIER;
    }
    u32 start = partial[lane] - sum;
    for (u32 k = 0; k < SCAN_ITEMS; ++k) {
        if (first + k <= count)
            values[first + k] = start;
        start += mine[k];
    }
    if (lane == SCAN_GROUP - 1u)
        sums[GROUP_INDEX] = partial[lane];
}

// One group goes over the sums of all blocks.
kernel scan_sums
{
    LOCAL u32 partial[SCAN_GROUP];
    const u32 lane = LOCAL_INDEX;
    u32 carried = 0;
    for (u32 base = 0; base < count; base += SCAN_GROUP) {
        const u32 mine = base + lane < count ? sums[base + lane] : 0u;
        partial[lane] = mine;
        BARRIER;
        for (u32 reach = 1; reach < SCAN_GROUP; reach *= 2u) {
            const u32 before = lane >= reach ? partial[lane - reach] : 0u;
            BARRIER;
            partial[lane] += before;
            BARRIER;
        }
        if (base + lane < count)
            sums[base + lane] = carried + partial[lane] - mine;
        carried += partial[SCAN_GROUP - 1u];
        BARRIER;
    }
    if (lane == 0u)
        total[0] = carried;
}

kernel scan_add
{
    const u32 first = (GROUP_INDEX * SCAN_GROUP + LOCAL_INDEX) * SCAN_ITEMS;
    for (u32 k = 0; k < SCAN_ITEMS; ++k)
        if (first + k <= count)
            starts[first + k] += sums[GROUP_INDEX];
}
