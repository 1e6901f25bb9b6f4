#pragma once
// What kind of network link an interface is, as the kernel's route socket says it. Asked for before
// a driver's CAN settings are: of a link that has none, libsocketcan complains on stderr.

#include <string>

namespace flatpose::port {

/// "can" of an interface with a controller, "vcan", ...; empty: it is of no kind, or not there.
/// Cost: as look_at_can().
[[nodiscard]] std::string link_kind_of(int index);

}  // namespace flatpose::port
