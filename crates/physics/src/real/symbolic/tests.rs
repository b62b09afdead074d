use super::*;
use crate::contact::normal::hertz;

/// The body of a function of `a` and `b` that writes its result to `*out`.
fn body(law: impl FnOnce(Symbol, Symbol) -> Symbol) -> String {
    let function = CFunction::record("void f(real a, real b, real *out)", |c| {
        c.output("*out", law(c.input("a"), c.input("b")));
    });
    let text = function.text.strip_prefix("void f(real a, real b, real *out)\n{\n").expect("the head comes first");
    text.strip_suffix("}\n").expect("the brace closes").to_owned()
}

/// What a panic said.
fn panic_of(misuse: impl FnOnce() + std::panic::UnwindSafe) -> String {
    let payload = std::panic::catch_unwind(misuse).expect_err("this must panic");
    payload.downcast_ref::<&str>().map(|s| (*s).to_owned()).or(payload.downcast_ref::<String>().cloned()).unwrap()
}

#[test]
fn a_law_prints_itself() {
    let head = "DEVICE void spring(const Law law, const Pair *pair, real *force)";
    let function = CFunction::record(head, |c| {
        let overlap = c.input("pair->overlap");
        let contact_radius = (c.input("pair->radius_eff") * overlap).sqrt().named("contact_radius");
        let force = hertz(c.input("law.normal_stiffness"), contact_radius, overlap);
        let limit = c.input("law.limit");
        let force = Real::when(force.gt(limit), force, |force: Symbol| limit + (force - limit) / Symbol::lit(3.0));
        c.output("*force", -force);
    });
    assert_eq!(
        function.text,
        "\
DEVICE void spring(const Law law, const Pair *pair, real *force)
{
    const real pair_overlap = pair->overlap;
    const real pair_radius_eff = pair->radius_eff;
    const real law_normal_stiffness = law.normal_stiffness;
    const real law_limit = law.limit;
    const real t1 = pair_radius_eff * pair_overlap;
    const real contact_radius = sqrt(t1);
    const real t2 = law_normal_stiffness * contact_radius;
    const real t3 = t2 * pair_overlap;
    const int t4 = t3 > law_limit;
    real t5 = t3;
    if (t4) {
        const real t6 = t3 - law_limit;
        const real t7 = t6 / 3.0;
        const real t8 = law_limit + t7;
        t5 = t8;
    }
    const real t9 = -t5;
    *force = t9;
}
"
    );
    let always =
        Operations { multiplications: 3, square_roots: 1, comparisons: 1, sign_changes: 1, ..Operations::default() };
    assert_eq!(function.always, always);
    assert_eq!(function.in_branches, Operations { additions: 2, divisions: 1, ..Operations::default() });
    assert_eq!(function.operations().arithmetic(), 7);
}

#[test]
fn equal_expressions_share_a_temporary_and_unequal_ones_do_not() {
    assert_eq!(
        body(|a, b| (a + b) * (a + b) - (b + a)),
        "    const real t1 = a + b;
    const real t2 = t1 * t1;
    const real t3 = b + a;
    const real t4 = t2 - t3;
    *out = t4;
"
    );
}

#[test]
fn identities_that_do_not_hold_for_every_bit_are_kept() {
    let zero = || Symbol::lit(0.0);
    assert!(body(|a, _| a + zero()).contains("a + 0.0"), "-0 + 0 is +0");
    assert!(body(|a, _| zero() - a).contains("0.0 - a"), "0 - 0 is not -0");
    assert!(body(|a, _| -a).contains("-a"));
    assert!(body(|a, _| a * zero()).contains("a * 0.0"));
    assert!(body(|a, _| a - a).contains("a - a"));
    assert!(body(|a, _| a / Symbol::lit(3.0)).contains("a / 3.0"));
    assert!(body(|a, b| a + Symbol::lit(-0.0) + b * zero()).contains("a + (-0.0)"), "signed zeros are two constants");
}

#[test]
fn constants_fold_unless_they_give_nan() {
    let lit = Symbol::lit;
    assert_eq!(body(|_, _| lit(2.0) / lit(3.0) + lit(9.0).sqrt()), "    *out = 3.6666666666666665;\n");
    assert_eq!(body(|_, _| -lit(0.0)), "    *out = (-0.0);\n");
    assert_eq!(body(|_, _| lit(-1.0).abs().min(lit(7.0))), "    *out = 1.0;\n");
    assert_eq!(body(|a, _| Real::when(lit(1.0).gt(lit(2.0)), a, |a: Symbol| a + a)), "    *out = a;\n");
    assert_eq!(
        body(|_, _| lit(f64::INFINITY) - lit(f64::INFINITY)),
        "    const real t1 = INFINITY - INFINITY;\n    *out = t1;\n"
    );
}

#[test]
fn literals_are_exact() {
    for (value, text) in [
        (0.1 + 0.2, "0.30000000000000004"),
        (5e-324, "5e-324"),
        (f64::MAX, "1.7976931348623157e308"),
        (1e22, "1e22"),
        (-2.5, "(-2.5)"),
        (f64::INFINITY, "INFINITY"),
        (f64::NEG_INFINITY, "(-INFINITY)"),
        (f64::NAN, "NAN"),
    ] {
        assert_eq!(body(|_, _| Symbol::lit(value)), format!("    *out = {text};\n"));
    }
}

#[test]
fn names_are_unique_and_leave_the_head_and_keywords_alone() {
    assert_eq!(
        body(|a, b| {
            let sum = (a + b).named("size");
            let again = (a + b).named("ignored");
            (sum * again).named("size").abs().named("out").sqrt().named("half")
        }),
        "    const real size = a + b;
    const real size_2 = size * size;
    const real out_2 = fabs(size_2);
    const real half_2 = sqrt(out_2);
    *out = half_2;
"
    );
    assert!(panic_of(|| drop(body(|a, b| (a + b).named("2x")))).contains("no identifier"));
}

#[test]
fn branches_share_with_the_outside_but_not_with_each_other() {
    assert_eq!(
        body(|a, b| {
            let product = a * b;
            let twice = |x: Symbol| x + a * b + a * a;
            let first = Real::when(a.gt(b), product, twice);
            let second = Real::when(b.gt(a), product, twice);
            first - second
        }),
        "    const real t1 = a * b;
    const int t2 = a > b;
    real t3 = t1;
    if (t2) {
        const real t4 = t1 + t1;
        const real t5 = a * a;
        const real t6 = t4 + t5;
        t3 = t6;
    }
    const int t7 = b > a;
    real t8 = t1;
    if (t7) {
        const real t9 = t1 + t1;
        const real t10 = a * a;
        const real t11 = t9 + t10;
        t8 = t11;
    }
    const real t12 = t3 - t8;
    *out = t12;
"
    );
}

#[test]
fn branches_nest_and_change_only_what_they_must() {
    assert_eq!(
        body(|a, b| {
            let (first, second) = Real::when(a.gt(b), (a, b), |(a, b): (Symbol, Symbol)| {
                (Real::when(b.gt(Symbol::lit(0.0)), a, |a: Symbol| a / b), b)
            });
            first.max(second)
        }),
        "    const int t1 = a > b;
    real t2 = a;
    if (t1) {
        const int t3 = b > 0.0;
        real t4 = a;
        if (t3) {
            const real t5 = a / b;
            t4 = t5;
        }
        t2 = t4;
    }
    const int t6 = t2 > b;
    const real t7 = t6 ? t2 : b;
    *out = t7;
"
    );
}

#[test]
fn what_nobody_uses_is_not_computed() {
    let text = body(|a, b| {
        let _unused = Real::when(a.gt(b), a * b, |x: Symbol| x / b);
        a + b
    });
    assert_eq!(text, "    const real t1 = a + b;\n    *out = t1;\n");
}

#[test]
fn inputs_are_read_before_outputs_are_written() {
    let swap = CFunction::record("void swap(real *p)", |c| {
        let (a, b) = (c.input("p[0]"), c.input("p[1]"));
        c.output("p[0]", b);
        c.output("p[1]", a);
    });
    assert_eq!(
        swap.text,
        "void swap(real *p)
{
    const real p_0 = p[0];
    const real p_1 = p[1];
    p[0] = p_1;
    p[1] = p_0;
}
"
    );
}

#[test]
fn misuse_is_told() {
    let outside = panic_of(|| _ = Symbol::lit(1.0));
    assert!(outside.contains("no recording runs"), "{outside}");
    let nested = panic_of(|| drop(CFunction::record("void f()", |_| drop(CFunction::record("void g()", |_| {})))));
    assert!(nested.contains("cannot be nested"), "{nested}");
    let mut kept = None;
    drop(body(|a, _| *kept.insert(a)));
    let stale = panic_of(move || drop(body(|a, _| a + kept.unwrap())));
    assert!(stale.contains("another recording"), "{stale}");
    let leaked = panic_of(|| {
        let _ = body(|a, b| {
            let mut inner = None;
            let _ = Real::when(a.gt(b), a, |a: Symbol| *inner.insert(a * b));
            inner.unwrap() + a
        });
    });
    assert!(leaked.contains("made inside Real::when"), "{leaked}");
    let early = panic_of(|| {
        let _ = CFunction::record("void f(real a, real *p)", |c| {
            let a = c.input("a");
            let _ = Real::when(a.gt(Symbol::lit(0.0)), a, |a: Symbol| {
                c.output("*p", a);
                a
            });
        });
    });
    assert!(early.contains("set it after the branch"), "{early}");
    let by_value = panic_of(|| drop(CFunction::record("void f(real a)", |c| c.output("a", c.input("a")))));
    assert!(by_value.contains("parameter by value"), "{by_value}");
    // Each of these panics left the thread ready for the next recording.
    assert_eq!(body(|a, _| a), "    *out = a;\n");
}
