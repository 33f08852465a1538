/* What a collision does, learned or in closed form, from C, Fortran, Python (ctypes), LAMMPS or a Fluent
 * UDF: a small interface over particle::CollisionModel, the library elrom-collision-c.
 *
 * Functions that can fail return a status: 0 done, 2 wrong use, 3 wrong file or input, 1 anything else (the
 * exit statuses of the programs); elrom_collision_last_error() says why in one line.
 * Everything is in SI and 64-bit. A vector of n pairs is n x 3, row-major: x, y, z of pair 0, then of pair 1.
 * Threads: any number of threads may call any function on one model, except elrom_collision_close(). */
#ifndef ELROM_COLLISION_H
#define ELROM_COLLISION_H

#include <stddef.h>

#if defined(__GNUC__)
#define ELROM_API __attribute__((visibility("default")))
#else
#define ELROM_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct elrom_collision elrom_collision;

/* Why the last call of this thread failed; valid until its next call. */
ELROM_API const char* elrom_collision_last_error(void);

/* Opens what elrom-train collisions wrote (collision.elrom). NULL on failure. */
ELROM_API elrom_collision* elrom_collision_open(const char* path);
ELROM_API void elrom_collision_close(elrom_collision* model);
/* What it is, for people: "frame, chebyshev". Valid until elrom_collision_close(); NULL of no model. */
ELROM_API const char* elrom_collision_text(const elrom_collision* model);

/* What n collisions give each sphere. The spheres of a pair touch; the normal (a unit vector) points from the
 * centre of 1 to that of 2. Spheres are solid.
 *   in   velocity [m/s], spin [rad/s] (NULL: none of that sphere spins), normal: n x 3;
 *        diameter [m], density [kg/m3]: n
 *   out  linear: impulse [N s], to be divided by the mass pi/6 rho d^3;
 *        angular: impulse about the sphere's own centre [N m s] (NULL: not wanted), to be divided by the
 *        moment of inertia m d^2 / 10: n x 3
 * Add what the divisions give to the velocities and spins. Pairs that part, or whose velocities or spins are
 * not finite, get none. Status 3, and nothing is written, when a diameter, a density or a normal is none.
 * n may be 0. */
ELROM_API int elrom_collision_impulses(const elrom_collision* model, size_t n, const double* velocity_1,
                                       const double* velocity_2, const double* spin_1, const double* spin_2,
                                       const double* normal, const double* diameter_1,
                                       const double* diameter_2, const double* density_1,
                                       const double* density_2, double* linear_1, double* linear_2,
                                       double* angular_1, double* angular_2);

#ifdef __cplusplus
}
#endif

#endif
