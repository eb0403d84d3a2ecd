enum { POINT, FRAME, HINGE, DISTANCE, COUPLING };

/* A joint with one coordinate, or a ball with a quaternion x, y, z, w; R and p are those of its frame at rest. */
typedef struct {
    int parent, ball, turns, coordinate, velocity;
    double multiplier, offset, R[9], p[3], axis[3], advance[3];
} joint;

/* A joint that moves a constraint: +1 if it moves B, -1 if it moves A; the coefficient of a coupling. */
typedef struct {
    int joint;
    double factor;
} step;

/* Frames A and B in the joints that carry them, and the part of the path from first to last. */
typedef struct {
    int kind, rows, first, last, joint_a, joint_b;
    double R_a[9], p_a[3], R_b[9], p_b[3], length, axis_a[3], axis_b[3], across[2][3], scale[6];
} constraint;

/* Given joints, those asked for and those that follow; polynomials that predict the motion from `reference`; how far,
 * squared, positions may be from a stored pose. */
typedef struct {
    int given, asked, own, rows, rank, constraints, degrees;
    const int *given_velocity, *given_circular, *asked_velocity, *asked_circular, *asked_own,
        *own_velocity, *constraint;
    double error, sign, reach;
    const double *lower, *upper, *coefficients;
} drive;
