/* ELROM from C, Fortran, Python (ctypes) or a Fluent UDF: a small interface over model::Predictor,
 * the library elrom-c.
 *
 * Every function that can fail returns a status: 0 done, 2 wrong use, 3 wrong file or input, 5 arithmetic,
 * 1 anything else (the exit statuses of the programs); elrom_last_error() says why in one line.
 * Values are in SI and 32-bit; order: fields, planes, columns, with columns fastest.
 * Threads: any number of threads may call any function on one predictor, except elrom_close(). */
#ifndef ELROM_H
#define ELROM_H

#include <stddef.h>

#if defined(__GNUC__)
#define ELROM_API __attribute__((visibility("default")))
#else
#define ELROM_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct elrom_predictor elrom_predictor;

/* Why the last call of this thread failed; valid until its next call. */
ELROM_API const char* elrom_last_error(void);
/* "1.0.0" */
ELROM_API const char* elrom_version(void);

/* Opens a bundle. fields: comma-separated names, NULL or "" for all. NULL on failure. */
ELROM_API elrom_predictor* elrom_open(const char* bundle, const char* fields);
ELROM_API void elrom_close(elrom_predictor* predictor);

ELROM_API size_t elrom_n_inputs(const elrom_predictor* predictor);
ELROM_API size_t elrom_n_fields(const elrom_predictor* predictor);
ELROM_API size_t elrom_n_planes(const elrom_predictor* predictor);
ELROM_API size_t elrom_n_columns(const elrom_predictor* predictor);
/* Names and SI units; NULL when i is too large. Valid until elrom_close(). */
ELROM_API const char* elrom_input_name(const elrom_predictor* predictor, size_t i);
ELROM_API const char* elrom_input_unit(const elrom_predictor* predictor, size_t i);
ELROM_API const char* elrom_field_name(const elrom_predictor* predictor, size_t i);
ELROM_API const char* elrom_field_unit(const elrom_predictor* predictor, size_t i);

/* Cell centres [m]: xyz has n_planes * n_columns * 3 values. */
ELROM_API int elrom_cell_centres(const elrom_predictor* predictor, double* xyz);
/* Boundary conditions of a case in a cases file (CSV, JSON, TOML): inputs has n_inputs values. */
ELROM_API int elrom_read_case(const elrom_predictor* predictor, const char* cases, const char* name,
                              double* inputs);
/* All fields of one case: n_inputs inputs, n_fields * n_planes * n_columns values; n_threads >= 1. */
ELROM_API int elrom_predict(const elrom_predictor* predictor, const double* inputs, float* values,
                            int n_threads);
/* Predicts one case and writes its file as elrom-predict does (HDF5 for scripts and ParaView;
 * data/FORMATS.md, kind "elrom-prediction"). name: the case's in the file; load: fraction of full load,
 * NaN: not known. The file appears whole or not at all; one there is replaced. */
ELROM_API int elrom_write_prediction(const elrom_predictor* predictor, const double* inputs, const char* name,
                                     double load, const char* path, int n_threads);
/* verdict: 0 inside, 1 edge, 2 outside of what was trained; the reason, cut to
 * reason_size, ends with '\0'. */
ELROM_API int elrom_validity(const elrom_predictor* predictor, const double* inputs, int* verdict,
                             char* reason, size_t reason_size);

#ifdef __cplusplus
}
#endif

#endif
