#pragma once
// The CAN node in the forms that its users' tools read. All from the dictionary and the PDOs' own
// tables.

#include <string>

#include "port/linux/tool/served_map.hpp"

namespace flatpose::tool {

/// An electronic data sheet (CiA 306), for whatever node id.
/// Fails: port::InputError for a config, of which nothing can stand in it.
[[nodiscard]] std::string map_eds(const ServedMap& served = {});

/// The frames of one node for tools that know no CANopen.  Rotations are as the jobs have them, if
/// all have the same.
[[nodiscard]] std::string map_dbc(const ServedMap& served = {});

}  // namespace flatpose::tool
