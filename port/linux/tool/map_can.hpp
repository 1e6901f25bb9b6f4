#pragma once
// The CAN node in the forms that its users' tools read. All from the dictionary and the PDOs' own
// tables.

#include <string>

namespace flatpose::tool {

/// An electronic data sheet (CiA 306), for whatever node id.
[[nodiscard]] std::string map_eds();

/// The frames of one node for tools that know no CANopen.  `fd_frame_id` 0: the usual.
[[nodiscard]] std::string map_dbc(int node, int fd_frame_id = 0);

}  // namespace flatpose::tool
