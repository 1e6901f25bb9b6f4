#include "port/linux/daemon/reloader.hpp"

#include "port/linux/daemon/section.hpp"
#include "port/linux/files/input_error.hpp"

namespace flatpose::daemon {

std::shared_ptr<const JobSet> Reloader::load() {
  Config config = read_();
  for (const std::string& name : changed_tables(running_.text, config.text, {"part", "job"}))
    log_.line("warning: [" + name + "] has changed: that takes effect at the next start");
  config.source = running_.source;
  auto set = std::make_shared<JobSet>(load_jobs(config));
  if (job::validate(set->rules()) != Status::kOk)
    throw port::InputError("[[job]]", "the job machine refuses them", "run flatposed --check");
  for (const std::string& line : set->problems()) log_.line("warning: " + line);
  return set;
}

void Reloader::ask() {
  if (is_busy()) {
    is_asked_again_ = true;
    return;
  }
  ticket_ = engine_.asked_to_reload();
  try {
    waiting_ = load();
  } catch (const std::exception& error) {
    log_.line(std::string("jobs not reloaded, the old ones are in force: ") + error.what());
    return answer(false);
  }
  step();
}

void Reloader::step() {
  JobShelf& shelf = engine_.shelf();
  if (waiting_ != nullptr && shelf.has_room()) {
    if (ticket_ != 0 && engine_.asked_to_reload() != ticket_) return give_up();
    shelf.offer(std::move(waiting_));
    waiting_.reset();
    is_offered_ = true;
    if (has_bus_) {
      engine_.wake_bus();
    } else {
      shelf.adopt();
      engine_.ring();
    }
  }
  if (!is_offered_ || !shelf.is_adopted()) return;
  is_offered_ = false;
  log_.line("jobs reloaded");
  answer(true);
  if (std::exchange(is_asked_again_, false)) ask();
}

// Who asked has cancelled: nothing happens.
void Reloader::give_up() {
  waiting_.reset();
  ticket_ = 0;
  if (std::exchange(is_asked_again_, false)) ask();
}

void Reloader::answer(bool is_done) {
  if (ticket_ != 0) engine_.answer_reload(ticket_, is_done);
  ticket_ = 0;
}

}  // namespace flatpose::daemon
