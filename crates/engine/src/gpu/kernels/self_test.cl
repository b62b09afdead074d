// Operations whose rounding a device might change, for comparison with the host's bits.
typedef struct { real scale; u32 count; u32 rows; } Trial;

DEVICE real hidden_product(real a, real b) { return a * b; }

KERNEL(64, 1) self_test(GLOBAL const Quad *RESTRICT input, GLOBAL Quad *RESTRICT output, const Trial trial) {
    FOR_EACH(i, trial.count) {
        const Quad q = LOAD(input, i);
        const real product = q.x * q.y;
        const real across = product + q.z;
        const real within = q.x * q.y + q.z;
        const real minus = q.z - q.x * q.y;
        const real called = hidden_product(q.x, q.y) + q.z;
        real sum = trial.scale * q.w;
        sum += q.x * q.x;
        sum += q.y * q.y;
        const real root = sqrt(sum);
        output[trial.rows * i] = QUAD(within, across, minus, called);
        output[trial.rows * i + 1] = QUAD(root, q.x / root, 1.0 / root, q.x / q.y);
    }
}
