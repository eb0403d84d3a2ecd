/* Newton's method on the constraints of the loops. Tables above describe the mechanism. */

typedef struct {
    double R[9], p[3];
} pose;

static void times(const double A[9], const double B[9], double C[9]) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

static void turned(const double A[9], const double u[3], double v[3]) {
    for (int i = 0; i < 3; ++i) v[i] = A[3 * i] * u[0] + A[3 * i + 1] * u[1] + A[3 * i + 2] * u[2];
}

static void turned_back(const double A[9], const double u[3], double v[3]) {
    for (int i = 0; i < 3; ++i) v[i] = A[i] * u[0] + A[3 + i] * u[1] + A[6 + i] * u[2];
}

static void cross(const double u[3], const double v[3], double w[3]) {
    w[0] = u[1] * v[2] - u[2] * v[1];
    w[1] = u[2] * v[0] - u[0] * v[2];
    w[2] = u[0] * v[1] - u[1] * v[0];
}

static double dot(const double u[3], const double v[3]) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/* The rotation about a unit axis. */
static void about(const double a[3], double angle, double R[9]) {
    const double c = cos(angle), s = sin(angle), d = 1.0 - c;
    R[0] = c + d * a[0] * a[0], R[1] = d * a[0] * a[1] - s * a[2], R[2] = d * a[0] * a[2] + s * a[1];
    R[3] = d * a[0] * a[1] + s * a[2], R[4] = c + d * a[1] * a[1], R[5] = d * a[1] * a[2] - s * a[0];
    R[6] = d * a[0] * a[2] - s * a[1], R[7] = d * a[1] * a[2] + s * a[0], R[8] = c + d * a[2] * a[2];
}

/* The rotation of a unit quaternion x, y, z, w. */
static void of_quaternion(const double q[4], double R[9]) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    R[0] = 1.0 - 2.0 * (y * y + z * z), R[1] = 2.0 * (x * y - w * z), R[2] = 2.0 * (x * z + w * y);
    R[3] = 2.0 * (x * y + w * z), R[4] = 1.0 - 2.0 * (x * x + z * z), R[5] = 2.0 * (y * z - w * x);
    R[6] = 2.0 * (x * z - w * y), R[7] = 2.0 * (y * z + w * x), R[8] = 1.0 - 2.0 * (x * x + y * y);
}

/* The pose of a frame that is fixed in another one. */
static void fixed_in(const pose *a, const double R[9], const double p[3], pose *b) {
    times(a->R, R, b->R);
    turned(a->R, p, b->p);
    for (int i = 0; i < 3; ++i) b->p[i] += a->p[i];
}

/* The moving frames of all joints; number 0 is what carries the loops. */
static void place(const double x[], pose at[]) {
    at[0] = (pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    for (int j = 1; j < JOINTS; ++j) {
        const joint *own = &joints[j];
        pose rest;
        double R[9], along[3];
        fixed_in(&at[own->parent], own->R, own->p, &rest);
        if (BALLS && own->ball) {
            of_quaternion(&x[own->coordinate], R);
        } else {
            const double amount = own->multiplier * x[own->coordinate] + own->offset;
            turned(rest.R, own->advance, along);
            for (int i = 0; i < 3; ++i) rest.p[i] += amount * along[i];
            about(own->axis, own->turns ? amount : 0.0, R);
        }
        times(rest.R, R, at[j].R);
        for (int i = 0; i < 3; ++i) at[j].p[i] = rest.p[i];
    }
}

/* Adds a velocity of a joint to the rows of a closure: J (6, .) has the velocity of B's origin, and the turn, in A. */
static void add_twist(const pose *a, const double p_b[3], const pose *j, const double turn[3], const double advance[3],
                      double factor, double J[6][VELOCITIES], int velocity) {
    double w[3], v[3], lever[3], moved[3], seen[3];
    turned(j->R, turn, w);
    turned(j->R, advance, v);
    for (int i = 0; i < 3; ++i) lever[i] = p_b[i] - j->p[i];
    cross(w, lever, moved);
    for (int i = 0; i < 3; ++i) v[i] += moved[i];
    turned_back(a->R, v, seen);
    for (int i = 0; i < 3; ++i) J[i][velocity] += factor * seen[i];
    turned_back(a->R, w, seen);
    for (int i = 0; i < 3; ++i) J[3 + i][velocity] += factor * seen[i];
}

/* s * angle / sin(angle), where s = sin(angle) * axis and c = cos(angle). */
static void rotation_vector(const double s[3], double c, double out[3]) {
    const double sine = sqrt(dot(s, s)), scale = sine > 0.0 ? atan2(sine, c) / sine : 1.0;
    for (int i = 0; i < 3; ++i) out[i] = scale * s[i];
}

/* The residual of a constraint, m and rad, and its derivative, which is exact where it is closed. */
static void constrain(const constraint *own, const double x[], const pose at[], double r[6],
                      double K[6][VELOCITIES]) {
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, none[3] = {0, 0, 0};
    double J[6][VELOCITIES] = {{0}}, p[3], R[9], apart[3], s[3], turn[3];
    pose a, b;
    if (own->kind == COUPLING) {
        r[0] = -own->length;
        for (int v = 0; v < VELOCITIES; ++v) K[0][v] = 0.0;
        for (int k = own->first; k < own->last; ++k) {
            r[0] += path[k].factor * x[joints[path[k].joint].coordinate];
            K[0][joints[path[k].joint].velocity] += path[k].factor;
        }
        return;
    }
    fixed_in(&at[own->joint_a], own->R_a, own->p_a, &a);
    fixed_in(&at[own->joint_b], own->R_b, own->p_b, &b);
    for (int i = 0; i < 3; ++i) apart[i] = b.p[i] - a.p[i];
    turned_back(a.R, apart, p);
    for (int k = own->first; k < own->last; ++k) {
        const joint *j = &joints[path[k].joint];
        const pose *here = &at[path[k].joint];
        if (BALLS && j->ball)
            for (int i = 0; i < 3; ++i) add_twist(&a, b.p, here, unit[i], none, path[k].factor, J, j->velocity + i);
        else
            add_twist(&a, b.p, here, j->turns ? j->axis : none, j->advance, path[k].factor * j->multiplier, J,
                      j->velocity);
    }
    if (own->kind == DISTANCE) {
        const double length = sqrt(dot(p, p));
        r[0] = length - own->length;
        for (int v = 0; v < VELOCITIES; ++v) K[0][v] = (p[0] * J[0][v] + p[1] * J[1][v] + p[2] * J[2][v]) / length;
        return;
    }
    for (int i = 0; i < 3; ++i) {
        r[i] = p[i];
        for (int v = 0; v < VELOCITIES; ++v) K[i][v] = J[i][v];
    }
    if (own->kind == POINT) return;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            R[3 * i + j] = a.R[i] * b.R[j] + a.R[3 + i] * b.R[3 + j] + a.R[6 + i] * b.R[6 + j];
    if (own->kind == FRAME) {
        s[0] = 0.5 * (R[7] - R[5]), s[1] = 0.5 * (R[2] - R[6]), s[2] = 0.5 * (R[3] - R[1]);
        rotation_vector(s, 0.5 * (R[0] + R[4] + R[8] - 1.0), turn);
        for (int i = 0; i < 3; ++i) {
            r[3 + i] = turn[i];
            for (int v = 0; v < VELOCITIES; ++v) K[3 + i][v] = J[3 + i][v];
        }
        return;
    }
    double axis[3]; /* HINGE: b's axis seen from A, and the plane across a's */
    turned(R, own->axis_b, axis);
    cross(own->axis_a, axis, s);
    rotation_vector(s, dot(own->axis_a, axis), turn);
    for (int i = 0; i < 2; ++i) {
        r[3 + i] = dot(own->across[i], turn);
        for (int v = 0; v < VELOCITIES; ++v)
            K[3 + i][v] = own->across[i][0] * J[3][v] + own->across[i][1] * J[4][v] + own->across[i][2] * J[5][v];
    }
}

/* The constraints at a pose: A (rows, own) and, as right sides, -r and -K of the given velocities; dimensionless. */
static double constraints_at(const drive *by, const double x[], double A[ROWS][VELOCITIES], double b[ROWS][SIDES]) {
    pose at[JOINTS];
    double r[6], K[6][VELOCITIES], largest = 0.0;
    int row = 0;
    place(x, at);
    for (int c = 0; c < by->constraints; ++c) {
        const constraint *own = &constraints[by->constraint[c]];
        constrain(own, x, at, r, K);
        for (int i = 0; i < own->rows; ++i, ++row) {
            const double scale = own->scale[i];
            if (!(fabs(r[i]) <= largest)) largest = fabs(r[i]);
            b[row][0] = -scale * r[i];
            for (int k = 0; k < by->own; ++k) A[row][k] = scale * units[by->own_velocity[k]] * K[i][by->own_velocity[k]];
            for (int k = 0; k < by->given; ++k)
                b[row][1 + k] = -scale * units[by->given_velocity[k]] * K[i][by->given_velocity[k]];
        }
    }
    return largest;
}

/* A y = b by Householder reflections with column pivoting, for a matrix of known rank; 0 if its rank is lower. */
static int solve(const drive *by, double A[ROWS][VELOCITIES], double b[ROWS][SIDES], double y[VELOCITIES][SIDES]) {
    const int m = by->rows, n = by->own, sides = 1 + by->given;
    int order[VELOCITIES];
    double first = 0.0;
    for (int k = 0; k < n; ++k) order[k] = k;
    for (int k = 0; k < by->rank; ++k) {
        int best = k;
        double most = -1.0;
        for (int j = k; j < n; ++j) {
            double square = 0.0;
            for (int i = k; i < m; ++i) square += A[i][j] * A[i][j];
            if (square > most) most = square, best = j;
        }
        const double length = sqrt(most);
        if (k == 0) first = length;
        if (!(length > SINGULAR * first)) return 0;
        for (int i = 0; i < m && best != k; ++i) {
            const double kept = A[i][k];
            A[i][k] = A[i][best], A[i][best] = kept;
        }
        const int which = order[k];
        order[k] = order[best], order[best] = which;
        const double pivot = A[k][k] > 0.0 ? -length : length;
        A[k][k] -= pivot; /* the reflection is that along column k, from here down */
        double square = 0.0;
        for (int i = k; i < m; ++i) square += A[i][k] * A[i][k];
        for (int j = k + 1; j < n; ++j) {
            double sum = 0.0;
            for (int i = k; i < m; ++i) sum += A[i][k] * A[i][j];
            for (int i = k; i < m; ++i) A[i][j] -= 2.0 * sum / square * A[i][k];
        }
        for (int j = 0; j < sides; ++j) {
            double sum = 0.0;
            for (int i = k; i < m; ++i) sum += A[i][k] * b[i][j];
            for (int i = k; i < m; ++i) b[i][j] -= 2.0 * sum / square * A[i][k];
        }
        A[k][k] = pivot;
    }
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < sides; ++j) y[k][j] = 0.0;
    for (int k = by->rank - 1; k >= 0; --k)
        for (int j = 0; j < sides; ++j) {
            double sum = b[k][j];
            for (int i = k + 1; i < by->rank; ++i) sum -= A[k][i] * y[order[i]][j];
            y[order[k]][j] = sum / A[k][k];
        }
    return 1;
}

/* Whether the loops let the given velocities move independently: what the reflections left of their right sides. */
static int consistent(const drive *by, double b[ROWS][SIDES]) {
    for (int i = by->rank; i < by->rows; ++i)
        for (int j = 1; j <= by->given; ++j)
            if (!(fabs(b[i][j]) <= DETERMINED)) return 0;
    return 1;
}

static void move(const drive *by, double y[VELOCITIES][SIDES], double x[]) {
    for (int k = 0; k < by->own; ++k) {
        const int velocity = by->own_velocity[k], coordinate = coordinates[velocity];
        if (coordinate >= 0) {
            x[coordinate] += units[velocity] * y[k][0];
            continue;
        }
        if (!BALLS || coordinate != BALL) continue; /* the second and third velocity of a ball come with the first */
        const double w[3] = {0.5 * y[k][0], 0.5 * y[k + 1][0], 0.5 * y[k + 2][0]};
        const double half = sqrt(dot(w, w)), scale = half > 0.0 ? sin(half) / half : 1.0, c = cos(half);
        double *q = &x[ball_coordinates[velocity]], v[3], turned_by[3], norm;
        for (int i = 0; i < 3; ++i) v[i] = scale * w[i];
        cross(q, v, turned_by);
        const double real = q[3] * c - dot(q, v);
        for (int i = 0; i < 3; ++i) q[i] = q[i] * c + q[3] * v[i] + turned_by[i];
        q[3] = real;
        norm = sqrt(dot(q, q) + q[3] * q[3]);
        for (int i = 0; i < 4; ++i) q[i] /= norm;
    }
}

/* Newton's method at the given positions from about closed loops: whether it closes them, with their first correction
 * and the sum of the later ones. */
static int newton(const drive *by, double x[], double y[VELOCITIES][SIDES], double first[], double later[]) {
    double A[ROWS][VELOCITIES], b[ROWS][SIDES];
    for (int k = 0; k < by->own; ++k) first[k] = later[k] = 0.0;
    for (int step = 0; step <= STEPS; ++step) {
        double last = 0.0;
        const double open = constraints_at(by, x, A, b);
        if (!solve(by, A, b, y)) return open <= CLOSED ? AT_SINGULARITY : TOO_FAR;
        move(by, y, x);
        for (int k = 0; k < by->own; ++k) {
            if (step > 0) later[k] += y[k][0];
            else first[k] = y[k][0];
            if (step == 0 && fabs(y[k][0]) > LONGEST_MOTION) return TOO_FAR;
            last = fmax(last, fabs(y[k][0]));
        }
        /* Rounded numbers can make redundant rows contradict each other. */
        if (open <= CLOSED || (open <= STILL_CLOSED && last <= CLOSED))
            return consistent(by, b) ? CLOSED_POSE : AT_SINGULARITY;
    }
    return TOO_FAR;
}

/* What is closed near a closed pose, on its branch, with the given joints at other positions. */
static int close_near(const drive *by, const double from[], const double given[], double x[],
                      double y[VELOCITIES][SIDES]) {
    double first[VELOCITIES], later[VELOCITIES], square = 0.0, corrected = 0.0;
    for (int k = 0; k < COORDINATES; ++k) x[k] = from[k];
    for (int k = 0; k < by->given; ++k) {
        const int coordinate = coordinates[by->given_velocity[k]];
        const double step = (given[k] - x[coordinate]) / units[by->given_velocity[k]];
        if (by->constraints > 0 && fabs(step) > LONGEST_MOTION) return TOO_FAR;
        x[coordinate] = given[k];
        square += step * step;
    }
    const int status = newton(by, x, y, first, later);
    if (status != CLOSED_POSE) return status;
    for (int k = 0; k < by->own; ++k) square += first[k] * first[k], corrected += later[k] * later[k];
    return sqrt(corrected) <= fmax(MOST_CORRECTION * sqrt(square), LEAST_CORRECTION) ? CLOSED_POSE : TOO_FAR;
}

/* The derivative of the joints asked for by the given ones, at a pose that was solved for. */
static void derive(const drive *by, double y[VELOCITIES][SIDES], double D[]) {
    for (int i = 0; i < by->asked; ++i)
        for (int k = 0; k < by->given; ++k) {
            const int velocity = by->asked_velocity[i], own = by->asked_own[i];
            D[i * by->given + k] = own < 0 ? (velocity == by->given_velocity[k] ? 1.0 : 0.0)
                                           : units[velocity] * y[own][1 + k] / units[by->given_velocity[k]];
        }
}

/* What is closed next to the pose that the polynomials predict, whatever the last pose is. */
static int close_predicted(const drive *by, const double given[], double x[], double y[VELOCITIES][SIDES]) {
    double T[SIDES][DEGREES], first[VELOCITIES], later[VELOCITIES], D[MATRIX < 4 ? 4 : MATRIX];
    const double *c = by->coefficients;
    if (by->degrees == 0) return TOO_FAR;
    for (int k = 0; k < by->given; ++k) {
        const double t = (2.0 * given[k] - by->lower[k] - by->upper[k]) / (by->upper[k] - by->lower[k]);
        if (!(fabs(t) <= 1.0)) return TOO_FAR;
        T[k][0] = 1.0, T[k][1] = t;
        for (int i = 2; i < DEGREES; ++i) T[k][i] = 2.0 * t * T[k][i - 1] - T[k][i - 2];
    }
    for (int k = 0; k < by->own; ++k) {
        y[k][0] = 0.0;
        for (int i = 0; i < by->degrees; ++i) {
            double sum = *c++;
            for (int j = 1; by->given > 1 && j < by->degrees; ++j) sum += *c++ * T[1][j];
            y[k][0] += sum * T[0][i];
        }
    }
    for (int k = 0; k < COORDINATES; ++k) x[k] = reference[k];
    for (int k = 0; k < by->given; ++k) x[coordinates[by->given_velocity[k]]] = given[k];
    move(by, y, x);
    if (newton(by, x, y, first, later) != CLOSED_POSE) return TOO_FAR;
    for (int k = 0; k < by->own; ++k)
        if (!(fabs(first[k] + later[k]) <= by->error)) return TOO_FAR;
    derive(by, y, D); /* the sign of its determinant changes at dead points */
    return by->sign * (by->given > 1 ? D[0] * D[3] - D[1] * D[2] : D[0]) < 0.0 ? TOO_FAR : CLOSED_POSE;
}

/* How far the given joints are from positions at a pose, squared. */
static double distance(const drive *by, const double x[], const double given[]) {
    double square = 0.0;
    for (int k = 0; k < by->given; ++k) {
        double apart = given[k] - x[coordinates[by->given_velocity[k]]];
        if (by->given_circular[k]) apart = remainder(apart, TURN);
        apart /= units[by->given_velocity[k]];
        square += apart * apart;
    }
    return square;
}

/* Moves the given joints from a closed pose on a straight path. A substep that fails is halved; after two that do not,
 * the next one is twice as long. */
static int follow(const drive *by, const double given[], int substeps, double x[], double y[VELOCITIES][SIDES]) {
    double first[SIDES], motion[SIDES], there[SIDES], next[COORDINATES], done = 0.0, part = 1.0;
    int status = TOO_FAR, again = 0;
    for (int k = 0; k < by->given; ++k) {
        first[k] = x[coordinates[by->given_velocity[k]]];
        motion[k] = given[k] - first[k];
        if (by->given_circular[k]) motion[k] = remainder(motion[k], TURN);
    }
    for (int tried = 0; tried < substeps && part >= SHORTEST_STEP; ++tried) {
        for (int k = 0; k < by->given; ++k) there[k] = first[k] + (done + part) * motion[k];
        const int last = done + part >= 1.0, reached = close_near(by, x, there, next, y);
        status = last ? reached : TOO_FAR;
        if (reached != CLOSED_POSE) {
            part *= 0.5, again = 0;
            continue;
        }
        for (int k = 0; k < COORDINATES; ++k) x[k] = next[k];
        if (last) return CLOSED_POSE;
        done += part;
        part = fmin(again ? 2.0 * part : part, 1.0 - done), again = !again;
    }
    return status;
}

/* The closed pose at positions: the one that is predicted; else one on a path from the nearest of the stored poses; else
 * one on a path from x, which is where that path ends if it does not lead there. */
static int reach(const drive *by, const double given[], int substeps, double x[], double y[VELOCITIES][SIDES]) {
    double other[COORDINATES];
    int nearest = -1;
    for (int k = 0; k < by->given; ++k)
        if (!isfinite(given[k])) return NOT_FINITE;
    int status = close_predicted(by, given, other, y);
    if (status != CLOSED_POSE && by->degrees == 0 && POSES > 0) {
        double least = by->reach;
        status = close_near(by, x, given, other, y);
        for (int pose = 0; pose < POSES && status != CLOSED_POSE; ++pose) {
            const double apart = distance(by, poses[pose], given);
            if (apart <= least) least = apart, nearest = pose;
        }
        for (int k = 0; k < COORDINATES && nearest >= 0; ++k) other[k] = poses[nearest][k];
        if (nearest >= 0) status = follow(by, given, substeps, other, y);
    }
    if (status != CLOSED_POSE) return follow(by, given, substeps, x, y);
    for (int k = 0; k < COORDINATES; ++k) x[k] = other[k];
    return CLOSED_POSE;
}

/* The inverse of a derivative, at a pose at which it was solved for. */
static int inverted(const drive *by, const double D[], double inverse[]) {
    double A[ROWS][VELOCITIES], b[ROWS][SIDES], y[VELOCITIES][SIDES];
    drive square = *by;
    square.own = square.rows = square.rank = by->given;
    for (int i = 0; i < by->given; ++i) {
        b[i][0] = 0.0;
        for (int k = 0; k < by->given; ++k) {
            b[i][1 + k] = i == k ? 1.0 : 0.0;
            A[i][k] = D[i * by->given + k] * units[by->given_velocity[k]] / units[by->asked_velocity[i]];
        }
    }
    if (!solve(&square, A, b, y)) return 0;
    for (int i = 0; i < by->given; ++i)
        for (int k = 0; k < by->given; ++k)
            inverse[i * by->given + k] = y[i][1 + k] * units[by->given_velocity[i]] / units[by->asked_velocity[k]];
    return 1;
}

static int at_positions(const drive *by, double kept[], const double given[], double asked[], double derivative[],
                        double inverse[]) {
    double x[COORDINATES], y[VELOCITIES][SIDES], D[MATRIX], B[MATRIX] = {0.0};
    for (int k = 0; k < COORDINATES; ++k) x[k] = kept[k];
    const int status = reach(by, given, SUBSTEPS, x, y);
    if (status != CLOSED_POSE) return status;
    derive(by, y, D);
    if (inverse && !inverted(by, D, B)) return AT_SINGULARITY;
    for (int i = 0; i < by->asked; ++i) {
        const int k = coordinates[by->asked_velocity[i]];
        if (by->asked_circular[i]) x[k] = kept[k] + remainder(x[k] - kept[k], TURN);
        asked[i] = x[k];
    }
    for (int k = 0; k < by->asked * by->given; ++k) {
        if (derivative) derivative[k] = D[k];
        if (inverse) inverse[k] = B[k];
    }
    for (int k = 0; k < COORDINATES; ++k) kept[k] = x[k];
    return CLOSED_POSE;
}

static double sum_of_squares(const drive *by, double b[ROWS][SIDES]) {
    double sum = 0.0;
    for (int i = 0; i < by->rows; ++i) sum += b[i][0] * b[i][0];
    return sum;
}

/* Whether Levenberg-Marquardt steps from x close the loops, with the given joints held: a descent of eurdf.assemble. */
static int descend(const drive *by, double x[]) {
    double A[ROWS][VELOCITIES], b[ROWS][SIDES], y[VELOCITIES][SIDES], trial[COORDINATES], damping = 1e-3, more = 8.0;
    double M[ROWS + VELOCITIES][VELOCITIES], s[ROWS + VELOCITIES][SIDES]; /* A; sqrt(lambda) times the identity */
    drive damped = *by;
    damped.given = 0, damped.rank = by->own, damped.rows = by->rows + by->own;
    for (int step = 0, idle = 0; step < DESCENT_STEPS && idle <= IDLE_STEPS; ++step) {
        if (constraints_at(by, x, A, b) <= STILL_CLOSED) return 1;
        const double square = sum_of_squares(by, b);
        double trace = 0.0, largest = 1.0, expected = square;
        for (int i = 0; i < damped.rows; ++i) {
            s[i][0] = i < by->rows ? b[i][0] : 0.0;
            for (int k = 0; k < by->own; ++k) M[i][k] = i < by->rows ? A[i][k] : 0.0, trace += M[i][k] * M[i][k];
        }
        const double lambda = sqrt(fmax(damping * square, LEAST_DAMPING * trace));
        for (int k = 0; k < by->own; ++k) M[by->rows + k][k] = lambda;
        if (!solve(&damped, M, s, y)) return 0;
        for (int k = 0; k < by->own; ++k) largest = fmax(largest, fabs(y[k][0]));
        for (int k = 0; k < by->own; ++k) y[k][0] /= largest;
        for (int i = 0; i < by->rows; ++i) {
            double left = b[i][0];
            for (int k = 0; k < by->own; ++k) left -= A[i][k] * y[k][0];
            expected -= left * left;
        }
        if (!(expected > LEAST_GAIN * square)) return 0;
        for (int k = 0; k < COORDINATES; ++k) trial[k] = x[k];
        move(by, y, trial);
        constraints_at(by, trial, M, s);
        const double reached = sum_of_squares(by, s);
        const double gain = (square - reached) / expected;
        idle = reached < 0.98 * square ? 0 : idle + 1;
        if (!(gain > 0.01)) {
            damping *= more, more *= 2.0;
            continue;
        }
        more = 8.0;
        damping = fmax(damping * (gain > 0.75 ? 0.1 : gain > 0.25 ? 1.0 : 4.0), 1e-8);
        for (int k = 0; k < COORDINATES; ++k) x[k] = trial[k];
    }
    return constraints_at(by, x, A, b) <= STILL_CLOSED;
}

/* Whether a closed pose was found at the given positions, on any branch: from a pose and from random ones around it. */
static int closable(const drive *by, const double from[], const double given[]) {
    double x[COORDINATES], y[VELOCITIES][SIDES];
    uint32_t random = 1;
    for (int attempt = 0; attempt <= RESTARTS; ++attempt) {
        for (int k = 0; k < COORDINATES; ++k) x[k] = from[k];
        for (int k = 0; k < by->given; ++k) x[coordinates[by->given_velocity[k]]] = given[k];
        for (int k = 0; k < by->own && attempt > 0; ++k) {
            random = 1664525u * random + 1013904223u;
            y[k][0] = spreads[(attempt < SPREADS ? attempt : SPREADS) - 1] * ((double)random / 2147483648.0 - 1.0);
        }
        if (attempt > 0) move(by, y, x);
        if (descend(by, x)) return 1;
    }
    return 0;
}

static int start_at(const drive *by, double kept[], const double given[]) {
    double x[COORDINATES], y[VELOCITIES][SIDES];
    for (int k = 0; k < COORDINATES; ++k) x[k] = start[k];
    const int status = reach(by, given, MOST_SUBSTEPS, x, y);
    if (status == TOO_FAR && !closable(by, x, given)) return NOT_CLOSED;
    if (status != CLOSED_POSE) return status;
    for (int i = 0; i < by->asked; ++i) { /* turns are counted from here: those given as given, others from the start */
        const int k = coordinates[by->asked_velocity[i]];
        if (by->asked_circular[i]) x[k] = start[k] + remainder(x[k] - start[k], TURN);
    }
    for (int k = 0; k < by->given; ++k) x[coordinates[by->given_velocity[k]]] = given[k];
    for (int k = 0; k < COORDINATES; ++k) kept[k] = x[k];
    return CLOSED_POSE;
}
