#pragma once
// Parallel-for as an interface: lib says what may run side by side, the port says on which threads.

namespace flatpose {

class Executor {
 public:
  using Task = void (*)(void* context, int chunk_index);

  /// Runs task(context, i) for every i in [0, chunk_count), in any order, and returns when all are
  /// done. The chunks are fixed by the caller, so the result cannot depend on the thread count.
  virtual void parallel_for(int chunk_count, Task task, void* context) noexcept = 0;

 protected:
  ~Executor() = default;
};

/// One after the other, on the caller's thread.
class InlineExecutor final : public Executor {
 public:
  void parallel_for(int chunk_count, Task task, void* context) noexcept override {
    for (int i = 0; i < chunk_count; ++i) task(context, i);
  }
};

/// Has no state: one serves all.
inline constinit InlineExecutor callers_thread;

/// Calls `body(chunk_index)` for every chunk.
template <class Body>
void for_each_chunk(Executor& executor, int chunk_count, Body& body) noexcept {
  executor.parallel_for(
      chunk_count,
      [](void* context, int chunk_index) { (*static_cast<Body*>(context))(chunk_index); }, &body);
}

}  // namespace flatpose
