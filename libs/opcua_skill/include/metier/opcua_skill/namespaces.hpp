#pragma once

#include <cstdint>
#include <string_view>

namespace metier::opcua_skill {

/// Namespace of metier's additions to the published skill types.
inline constexpr std::string_view kMetierUri = "urn:metier:skills";
/// Namespace of SkillType and of the grippers (published 2020).
inline constexpr std::string_view kDeviceUri = "https://fortiss.org/UA/Device/";
/// Namespace of the move skills (published 2020).
inline constexpr std::string_view kRoboticsUri = "https://fortiss.org/UA/Robotics/";
/// Namespace of OPC 10000-100, devices.
inline constexpr std::string_view kDiUri = "http://opcfoundation.org/UA/DI/";
/// Namespace of OPC 40010-1, robotics.
inline constexpr std::string_view kOpcRoboticsUri = "http://opcfoundation.org/UA/Robotics/";
/// Numeric id of SkillStoppingEventType in the namespace of metier.
inline constexpr std::uint32_t kStoppingEventTypeId = 20344;

}  // namespace metier::opcua_skill
