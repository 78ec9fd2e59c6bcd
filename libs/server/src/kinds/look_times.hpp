#pragma once

#include <chrono>

namespace metier::server {

// Times of those who look for a robot or a skill again and again.

inline constexpr std::chrono::seconds kLongestSearch{20};
inline constexpr std::chrono::milliseconds kLookEvery{500};
inline constexpr std::chrono::seconds kPause{2};  ///< after an attempt without a change

}  // namespace metier::server
