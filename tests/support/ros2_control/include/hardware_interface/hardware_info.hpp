#pragma once
#include <string>
#include <vector>

namespace hardware_interface {
struct JointInfo {
    std::string name, role;
    double mechanical_reduction = 1.0, offset = 0.0;
};
struct ActuatorInfo {
    std::string name, role;
    double mechanical_reduction = 1.0, offset = 0.0;
};
struct TransmissionInfo {
    std::string name, type;
    std::vector<JointInfo> joints;
    std::vector<ActuatorInfo> actuators;
};
}  // namespace hardware_interface
