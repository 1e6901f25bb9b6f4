#include "flatpose/locate/instances.hpp"

#include "flatpose/core/sort.hpp"

namespace flatpose::locate {
namespace {

constexpr auto precedes = [](const Instance& a, const Instance& b) noexcept {
  if (a.rank() != b.rank()) return a.rank() > b.rank();
  const Vec3& p = a.work_T_object.position_mm;
  const Vec3& q = b.work_T_object.position_mm;
  if (p.x != q.x) return p.x < q.x;
  if (p.y != q.y) return p.y < q.y;
  return a.work_T_object.rotation.m < b.work_T_object.rotation.m;
};

}  // namespace

void Instances::add(const Pose& work_T_object, const Verification& verification) noexcept {
  Instance& instance = memory_[count_++];
  instance = Instance{};
  instance.work_T_object = work_T_object;
  instance.verification = verification;
}

bool Instances::contains(const Pose& pose, double near_mm, double radius_mm) const noexcept {
  for (int i = 0; i < count_; ++i) {
    const Pose& other = memory_[i].work_T_object;
    if (norm(other.position_mm - pose.position_mm) < near_mm &&
        angle_between_rad(other.rotation, pose.rotation) * radius_mm < near_mm)
      return true;
  }
  return false;
}

void Instances::sort() noexcept {
  sort_in_place(memory_.first(static_cast<std::size_t>(count_)), precedes);
}

}  // namespace flatpose::locate
