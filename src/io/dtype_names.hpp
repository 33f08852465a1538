#pragma once
// Names of tensor types as safetensors spells them; internal to io.

#include "elrom/base/enum_names.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::io {

inline constexpr base::EnumNames<DType, 6> dtype_names{"tensor type",
                                                       {{DType::f16, "F16"},
                                                        {DType::f32, "F32"},
                                                        {DType::f64, "F64"},
                                                        {DType::i32, "I32"},
                                                        {DType::i64, "I64"},
                                                        {DType::u8, "U8"}}};

}  // namespace elrom::io
