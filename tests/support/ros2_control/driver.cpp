// A hardware component without hardware, for ctypes: loads the plugin as ros2_control states its <transmission>.
#include <deque>

#include "transmission.hpp"

extern "C" transmission_interface::TransmissionLoader *plugin(const char *type);

namespace {
hardware_interface::TransmissionInfo info;
std::vector<transmission_interface::JointHandle> joints;
std::vector<transmission_interface::ActuatorHandle> actuators;
std::shared_ptr<transmission_interface::Transmission> loaded;
std::deque<double> values;
std::string message;
}  // namespace

extern "C" {
void clear() { info = {"t", "", {}, {}}, joints.clear(), actuators.clear(); }

void element(bool of_joint, const char *name, const char *role, double reduction, double offset) {
    if (of_joint) info.joints.push_back({name, role, reduction, offset});
    else info.actuators.push_back({name, role, reduction, offset});
}

double *handle(bool of_joint, const char *name, const char *interface) {
    double *value = &values.emplace_back(0.0);
    if (of_joint) joints.emplace_back(name, interface, value);
    else actuators.emplace_back(name, interface, value);
    return value;
}

const char *load(const char *type) {
    const std::unique_ptr<transmission_interface::TransmissionLoader> loader(plugin(type));
    try {
        if (!loader) throw std::runtime_error("there is no such plugin");
        loaded = loader->load(info);
        loaded->configure(joints, actuators);
        message.clear();
    } catch (const std::exception &error) {
        message = error.what();
    }
    return message.c_str();
}

int run(bool to_joints) {
    to_joints ? loaded->actuator_to_joint() : loaded->joint_to_actuator();
    return std::dynamic_pointer_cast<DRIVEN::Transmission>(loaded)->status();
}
}
