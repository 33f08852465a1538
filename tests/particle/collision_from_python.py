"""What collision_from_c.c does, by ctypes. Arguments: library, model."""
import ctypes
import sys

library = ctypes.CDLL(sys.argv[1])
library.elrom_collision_open.restype = ctypes.c_void_p
library.elrom_collision_open.argtypes = [ctypes.c_char_p]
library.elrom_collision_close.argtypes = [ctypes.c_void_p]
library.elrom_collision_last_error.restype = ctypes.c_char_p
doubles = ctypes.POINTER(ctypes.c_double)
library.elrom_collision_impulses.argtypes = [ctypes.c_void_p, ctypes.c_size_t] + 13 * [doubles]


def array(*values):
    return (ctypes.c_double * len(values))(*values)


n = 3
velocity_1 = array(1, 0.5, -0.25, 2, 0, 0, -1, 0, 0)
velocity_2 = array(-1, 0, 0, 0, 1, 0, 1, 0, 0)
spin_1 = array(0, 0, 500, -300, 0, 0, 0, 0, 0)
normal = array(1, 0, 0, 0.6, -0.8, 0, 1, 0, 0)
diameter_1, diameter_2 = array(315e-6, 315e-6, 315e-6), array(475e-6, 315e-6, 475e-6)
density_1, density_2 = array(1000, 1200, 1000), array(1000, 1000, 1000)
outputs = [array(*(3 * n * [0])) for _ in range(4)]

model = library.elrom_collision_open(sys.argv[2].encode())
if not model:
    sys.exit(library.elrom_collision_last_error().decode())
status = library.elrom_collision_impulses(model, n, velocity_1, velocity_2, spin_1, None, normal, diameter_1, diameter_2,
                                          density_1, density_2, *outputs)
if status:
    sys.exit(library.elrom_collision_last_error().decode())
for i in range(n):
    print(*(repr(output[3 * i + axis]) for output in outputs for axis in range(3)))
library.elrom_collision_close(model)
