#pragma once
// What a call reports. Outcomes of a search (no match, deadline reached) are not errors: see
// locate/outcome.hpp.

namespace flatpose {

enum class [[nodiscard]] Status{
    kOk = 0,
    kInvalidArgument,  ///< A config field is outside its documented range.
    kShapeMismatch,    ///< Two images that must have one size differ.
    kOutOfMemory,   ///< The arena given by the caller is too small: see the required_bytes of the
                    ///< call.
    kTooLarge,      ///< A stated limit (points, cells, edges) would be passed.
    kNotFinite,     ///< A number that must be finite is not.
    kTooFewPoints,  ///< Not enough valid data to compute anything.
    kNoPart,        ///< The region holds nothing that stands out as a part.
    kSeveralParts,  ///< More than one part stands out: say which by a region.
    kNoContour,     ///< The part has no usable contour.
    kBadMagic,      ///< Not a file of this kind.
    kBadVersion,    ///< Written by a newer version.
    kBadChecksum,   ///< Bytes were changed since it was written.
    kTruncated,     ///< Fewer bytes than the header promises.
    kStopped,       ///< The budget was over before the work was done.
};

/// The enumerator's name in words, for logs.
[[nodiscard]] const char* to_string(Status status) noexcept;

}  // namespace flatpose
