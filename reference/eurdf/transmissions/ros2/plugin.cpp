#include "${package}/transmission.hpp"

#include "pluginlib/class_list_macros.hpp"

PLUGINLIB_EXPORT_CLASS(${package}::TransmissionLoader, transmission_interface::TransmissionLoader)
