#pragma once
// How deep a call's stack went: it runs on a thread whose stack was painted before, and where the
// paint is gone it was used. A judge from outside of what the call graph says.

#include <cstddef>

namespace flatpose::bench {

/// Bytes of stack below the call of `run(context)` that it wrote to, given `stack_bytes` to use.
/// Fails: std::runtime_error when the system gives no such thread.
[[nodiscard]] std::size_t stack_taken_by(std::size_t stack_bytes, void (*run)(void* context),
                                         void* context);

template <class Body>
[[nodiscard]] std::size_t stack_taken(std::size_t stack_bytes, Body&& body) {
  return stack_taken_by(
      stack_bytes, [](void* context) { (*static_cast<Body*>(context))(); }, &body);
}

}  // namespace flatpose::bench
