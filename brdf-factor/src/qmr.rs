//! Quasi-minimal residuals for the normal equations AᵀA x = Aᵀ y.
//!
//! Source: R. W. Freund and N. M. Nachtigal, "QMR: a quasi-minimal residual method for
//! non-Hermitian linear systems", Numerische Mathematik 60, 1991. For a symmetric matrix left and
//! right Lanczos vectors coincide and one product with the matrix per step is enough; the diagonal
//! is scaled to 1 beforehand, which keeps the symmetry.

use crate::LinearSystem;
use crate::iterated::Iterated;

/// Stop where ‖Aᵀ(y − A x)‖ has fallen to this share of ‖Aᵀ y‖.
const TOLERANCE: f64 = 1e-14;

pub(crate) fn solve(matrix: &LinearSystem, side: &[f64]) -> Iterated {
    let scale: Vec<f64> = matrix.column_norms_sq().iter().map(|n| 1.0 / n.sqrt()).collect();
    let scaled = |x: &[f64]| -> Vec<f64> { x.iter().zip(&scale).map(|(x, s)| x * s).collect() };
    let apply = |x: &[f64]| scaled(&matrix.apply_transposed(&matrix.apply(&scaled(x))));

    let unknowns = matrix.unknowns();
    let mut x = vec![0.0; unknowns];
    let mut residual = scaled(&matrix.apply_transposed(side));
    let start = norm(&residual);
    if start == 0.0 {
        return Iterated { values: x, iterations: 0, converged: true };
    }
    // Coupled two-term recurrences: v the Lanczos vector, p its search direction, d and s the
    // smoothed step and its image.
    let mut v = residual.clone();
    let mut rho = start;
    let (mut p, mut d, mut s) = (vec![0.0; unknowns], vec![0.0; unknowns], vec![0.0; unknowns]);
    let (mut epsilon, mut theta_sq, mut gamma_sq, mut eta) = (1.0, 0.0, 1.0, -1.0);
    // In exact arithmetic `unknowns` steps suffice; rounding asks for a multiple.
    let limit = 60 * unknowns + 1000;
    let (mut iterations, mut converged, mut broken) = (0, false, false);
    while iterations < limit && !converged && !broken {
        iterations += 1;
        let unit: Vec<f64> = v.iter().map(|v| v / rho).collect();
        let delta = dot(&unit, &unit);
        let back = if iterations == 1 { 0.0 } else { rho * delta / epsilon };
        for (p, v) in p.iter_mut().zip(&unit) {
            *p = v - back * *p;
        }
        let image = apply(&p);
        epsilon = dot(&p, &image);
        let beta = epsilon / delta;
        for ((v, image), unit) in v.iter_mut().zip(&image).zip(&unit) {
            *v = image - beta * unit;
        }
        let rho_next = norm(&v);
        let (old_theta_sq, old_gamma_sq) = (theta_sq, gamma_sq);
        theta_sq = rho_next * rho_next / (old_gamma_sq * beta * beta);
        gamma_sq = 1.0 / (1.0 + theta_sq);
        eta = -eta * rho * gamma_sq / (beta * old_gamma_sq);
        let carry = old_theta_sq * gamma_sq;
        for index in 0..unknowns {
            d[index] = eta * p[index] + carry * d[index];
            s[index] = eta * image[index] + carry * s[index];
            x[index] += d[index];
            residual[index] -= s[index];
        }
        rho = rho_next;
        converged = norm(&residual) <= TOLERANCE * start;
        broken = rho == 0.0 || epsilon <= 0.0;
    }
    Iterated { values: scaled(&x), iterations, converged }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}
