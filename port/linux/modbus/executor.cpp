#include "port/linux/modbus/executor.hpp"

#include <modbus.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

namespace flatpose::port {
namespace {

modbus_mapping_t mapping_of(modbus::Bank& bank) noexcept {
  modbus_mapping_t mapping{};
  mapping.nb_bits = static_cast<int>(bank.coils.size());
  mapping.tab_bits = bank.coils.data();
  mapping.nb_input_bits = static_cast<int>(bank.discrete_inputs.size());
  mapping.tab_input_bits = bank.discrete_inputs.data();
  mapping.nb_registers = mapping.nb_input_registers = static_cast<int>(bank.registers.size());
  mapping.tab_registers = mapping.tab_input_registers = bank.registers.data();
  return mapping;
}

}  // namespace

void LibmodbusExecutor::Free::operator()(_modbus* context) const noexcept { modbus_free(context); }

LibmodbusExecutor::LibmodbusExecutor() : context_(modbus_new_tcp(nullptr, 0)) {
  int ends[2] = {-1, -1};
  const bool is_made =
      context_ != nullptr &&
      socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) == 0;
  if (!is_made) throw std::system_error(errno, std::generic_category(), "Modbus executor");
  its_end_ = FileDescriptor(ends[0]);
  our_end_ = FileDescriptor(ends[1]);
  modbus_set_socket(context_.get(), its_end_.get());
  modbus_set_response_timeout(context_.get(), 0, 1);  // else an exception would sleep half a second
}

std::size_t LibmodbusExecutor::execute(std::span<const std::uint8_t> request, modbus::Bank& bank,
                                       std::span<std::uint8_t> response) noexcept {
  std::array<std::uint8_t, modbus::kAduBytesMax> adu{};
  const std::size_t adu_bytes = modbus::compose(0, 0, request, adu);
  if (adu_bytes == 0) return 0;
  modbus_mapping_t mapping = mapping_of(bank);
  if (modbus_reply(context_.get(), adu.data(), static_cast<int>(adu_bytes), &mapping) < 0) return 0;
  const ssize_t size = recv(our_end_.get(), adu.data(), adu.size(), 0);
  if (size <= modbus::kHeaderBytes) return 0;
  const auto pdu =
      std::span(adu).first(static_cast<std::size_t>(size)).subspan(modbus::kHeaderBytes);
  if (pdu.size() > response.size()) return 0;
  std::copy(pdu.begin(), pdu.end(), response.begin());
  return pdu.size();
}

}  // namespace flatpose::port
