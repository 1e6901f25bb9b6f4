// Reads the time.
#include <ctime>
long now() { return std::time(nullptr); }
