// Chains of multiplications and additions that wait neither for memory nor for each other.

// Side by side in a work-item: enough to keep its unit busy while each waits for itself.
#define CHAINS 8u

kernel chains
{
    FOR_EACH(i, chain.items) {
        real x[CHAINS];
        for (u32 k = 0; k < CHAINS; ++k)
            x[k] = (real)(CHAINS * i + k);
        for (u32 link = 0; link < chain.links; ++link) {
            for (u32 k = 0; k < CHAINS; ++k) {
                const real product = x[k] * chain.factor;
                x[k] = product + chain.term;
            }
        }
        real ends = 0.0;
        for (u32 k = 0; k < CHAINS; ++k)
            ends += x[k];
        sum[i] = ends;
    }
}
