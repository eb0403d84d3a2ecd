// Bounds of the solvers. Residuals are in m or rad; steps and motions in rad, or characteristic lengths of the loops.

export const CLOSED = 1e-6; // a closure that is open by no more is closed, EU-CLO-005
export const DEAD = 0.01; // a smallest singular value of K_p below this part of the largest one met is that of a dead point
export const SMALL = 0.01; // m: loops with a smaller characteristic length must close better, in proportion
export const SOLVED = 1e-12; // bound of the norm of the residual where loops were closed
export const BEYOND = 1e-9; // tolerance of a position limit, rad or m
