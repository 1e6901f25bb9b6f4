#pragma once
// The verdict on refined poses: what becomes a match, what is another pose in a match's place, and
// in which order the matches are reported.

#include <array>

#include "flatpose/core/image_view.hpp"
#include "flatpose/geometry/frames.hpp"
#include "flatpose/locate/locator.hpp"
#include "flatpose/locate/settings.hpp"
#include "flatpose/locate/verify.hpp"
#include "flatpose/refine/fine_images.hpp"
#include "flatpose/refine/polish.hpp"

namespace flatpose::locate {

enum class Verdict {
  kMatch,
  kNoMatch,
  /// It fits, but what is seen would be the same for the part slid along, or lying on its face.
  kGuess,
};

/// Considers poses best first and writes matches, rivals and misses into a result.
class Acceptance {
 public:
  /// What is referred to must outlive the acceptance; images may still be empty here.
  Acceptance(const model::Template& part, const Frames& frames, const LocateConfig& config,
             const Settings& settings, const Verifier& verifier, const refine::FineImages& fine,
             const ImageView<std::uint8_t>& claimed, LocateResult& result) noexcept
      : part_(part),
        frames_(frames),
        config_(config),
        settings_(settings),
        verifier_(verifier),
        fine_(fine),
        claimed_(claimed),
        result_(result) {}

  /// Takes a polished pose as the next match, when it is one; `alone` is its verification without
  /// any match. A pose that is none may become one later, when parts that adjoin it have been
  /// accepted.
  [[nodiscard]] Verdict consider(const refine::PolishResult& polished,
                                 const Verification& alone) noexcept;
  /// What a pose would be if no match stood in its way.
  [[nodiscard]] Verdict judge(const refine::PolishResult& polished,
                              const Verification& v) const noexcept;
  /// Whether a match accepted after the first `match_count` may bear on a pose that stands here.
  [[nodiscard]] bool is_claimed_near(const Vec3& position_work_mm, int match_count) const noexcept;
  /// Remembers how near a pose came that is no match.
  void note_rejected(double score) noexcept;
  /// Puts the matches in the order asked for.
  void sort() noexcept;

  [[nodiscard]] bool is_full() const noexcept { return result_.match_count >= config_.max_matches; }
  /// Whether the first match's place is explained about as well by a pose that is no equivalent of
  /// it.
  [[nodiscard]] bool is_ambiguous() const noexcept { return is_ambiguous_; }

 private:
  void note_rival(double score, const Pose& work_T_object) noexcept;
  [[nodiscard]] bool is_allowed(const Pose& work_T_object) const noexcept;
  [[nodiscard]] Match to_match(const refine::PolishResult& polished,
                               const Verification& v) const noexcept;

  const model::Template& part_;
  const Frames& frames_;
  const LocateConfig& config_;
  const Settings& settings_;
  const Verifier& verifier_;
  const refine::FineImages& fine_;
  const ImageView<std::uint8_t>& claimed_;
  LocateResult& result_;
  std::array<Vec3, kMatchCountMax> accepted_work_mm_;  ///< In the order of acceptance.
  bool is_ambiguous_ = false;
};

}  // namespace flatpose::locate
