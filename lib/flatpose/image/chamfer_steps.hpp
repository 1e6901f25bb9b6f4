#pragma once
// The steps of the 3-4 chamfer distance (Borgefors 1986).

namespace flatpose::image {

inline constexpr int kStraight_third_px = 3;
inline constexpr int kDiagonal_third_px = 4;

}  // namespace flatpose::image
