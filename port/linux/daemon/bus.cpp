#include "port/linux/daemon/bus.hpp"

#include <poll.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "port/linux/daemon/event_file.hpp"

namespace flatpose::daemon {
namespace {

constexpr std::int64_t kAskEvery_us = 500'000;
/// Ten questions: far more than a slow machine takes between two looks of a search.
constexpr std::int64_t kLivenessLimit_us = 5'000'000;
/// A turn takes far less, unless the machine has no time for it.
constexpr std::int64_t kStall_us = 10'000;
/// More than both mailboxes hold.
constexpr int kEventsPerTurn = 16;

std::uint16_t random_session() {
  std::uint16_t session = 0;
  while (session == 0) {
    if (getrandom(&session, sizeof session, 0) != sizeof session)
      throw std::runtime_error("the system gives no random numbers");
  }
  return session;
}

job::Config machine_config(const Config& config, std::uint16_t boot_count) {
  job::Config made;
  made.session_id = random_session();
  made.boot_count = boot_count;
  made.handshake = config.modbus.handshake;
  made.allow_simulated = config.source.allow_simulated;
  made.lease_us = config.lease_us.value_or(made.lease_us);
  made.liveness_limit_us = kLivenessLimit_us;
  return made;
}

modbus::Settings settings_of(const ModbusConfig& config) {
  modbus::Settings settings;
  settings.format = config.format;
  settings.own_unit = config.unit;
  settings.identity.revision = FLATPOSE_VERSION;
  return settings;
}

}  // namespace

Bus::Bus(const Config& config, const job::JobTable& jobs, SearchEngine& engine,
         std::uint16_t boot_count)
    : engine_(engine), modbus_(machine_, executor_, settings_of(config.modbus)) {
  if (machine_.init(machine_config(config, boot_count), jobs, clock_.now_us()) != Status::kOk)
    throw std::runtime_error("the job machine refuses its jobs");
  const ModbusConfig& modbus = config.modbus;
  if (modbus.is_on) server_.emplace(modbus.place, modbus.bind, modbus.port, -1, modbus.allowed);
  if (!config.can.is_on) return;
  can_.emplace(config.can, machine_, clock_.now_us());
  can_condition_.store(can_->condition());
  can_interface_ = config.can.interface;
  can_log_.emplace(can_interface_, config.can.node.node, can_->condition());
}

std::string Bus::name() const {
  std::string name = server_ ? "Modbus TCP on " + server_->name() : std::string();
  if (can_) name += (name.empty() ? "" : "; ") + can_->name();
  return name;
}

std::vector<std::string> Bus::news() {
  if (!can_log_) return {};
  const port::CanCondition fresh = can_condition_.load();
  const bool is_there = !fresh.is_down || port::look_at_can_link(can_interface_).index != 0;
  std::vector<std::string> lines = can_log_->lines(clock_.now_us(), fresh, is_there);
  if (!std::exchange(has_told_doubt_, true) && !can_->doubt().empty())
    lines.insert(lines.begin(), "warning: " + can_->doubt());
  return lines;
}

void Bus::start() {
  thread_ = std::thread([this] { work(); });
}

Bus::~Bus() {
  is_over_.store(true);
  engine_.wake_bus();
  if (thread_.joinable()) thread_.join();
}

void Bus::work() noexcept {
  while (!is_over_.load()) {
    turns_.fetch_add(1);
    if (clock_.now_us() >= ask_us_) {
      ask_us_ = clock_.now_us() + kAskEvery_us;
      engine_.ask();
    }
    wait(next_us() - clock_.now_us());
    if (can_) serve_can(clock_.now_us());
    take_events();
    if (server_) server_->serve(clock_.now_us(), *this);
    if (clock_.now_us() >= machine_us_) pass_on(machine_.process(machine_now_us(), {}));
    if (!can_) continue;
    pass_on(can_->station().tell(clock_.now_us()));
    can_condition_.store(can_->condition());
  }
}

void Bus::serve_can(std::int64_t now_us) noexcept {
  can_served_us_ = now_us;
  pass_on(can_->station().serve(now_us));
}

// The time to call the machine at. Frames bear the time of their arrival: what came before is taken
// in before, however long this thread stood still.
std::int64_t Bus::machine_now_us() noexcept {
  const std::int64_t now_us = clock_.now_us();
  if (can_ && now_us - can_served_us_ > kStall_us) serve_can(now_us);
  return now_us;
}

// The server's own set of sockets is one of what is waited for.
void Bus::wait(std::int64_t time_us) noexcept {
  std::array<pollfd, 3> watched{{{engine_.event(), POLLIN, 0},
                                 {server_ ? server_->waitable() : -1, POLLIN, 0},
                                 {can_ ? can_->socket() : -1, POLLIN, 0}}};
  const std::int64_t left_us = std::max<std::int64_t>(time_us, 0);
  const timespec limit{left_us / 1'000'000, left_us % 1'000'000 * 1000};
  (void)ppoll(watched.data(), watched.size(), &limit, nullptr);
  if (watched[0].revents != 0) clear_event(engine_.event());
  if (watched[1].revents != 0) server_->wait(0);
}

std::int64_t Bus::next_us() const noexcept {
  std::int64_t next = std::min(machine_us_, ask_us_);
  if (server_) next = std::min(next, server_->deadline_us());
  if (can_) next = std::min(next, can_->station().next_us());
  return next;
}

void Bus::take_events() noexcept {
  if (const job::JobTable* const jobs = engine_.shelf().offered()) {
    pass_on(machine_.process(machine_now_us(), {.jobs = jobs}));
    engine_.shelf().adopt();
    engine_.ring();
  }
  for (int i = 0; i < kEventsPerTurn && engine_.take(event_); ++i) {
    pass_on(machine_.process(machine_now_us(), {.event = &event_}));
    if (event_.kind == job::SearchEvent::Kind::kFinished)
      engine_.note_posted(event_.ticket, clock_.now_us());
  }
}

void Bus::pass_on(const job::Outputs& outputs) noexcept {
  machine_us_ = outputs.next_us;
  if (outputs.order.kind != job::Order::Kind::kNone) engine_.give(outputs.order);
}

std::size_t Bus::respond(const job::Master& master, const modbus::Adu& adu,
                         std::span<std::uint8_t, modbus::kAduBytesMax> response) noexcept {
  const modbus::Served served = modbus_.serve(machine_now_us(), master, adu, response);
  pass_on(served.outputs);
  return served.bytes;
}

job::Address Bus::owner() const noexcept { return machine_.snapshot(job::kNobody).owner_address; }

}  // namespace flatpose::daemon
