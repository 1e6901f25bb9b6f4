// Asks libm for what it may round as it likes.
#include <cmath>
double turned(double angle_rad) { return std::sin(angle_rad); }
