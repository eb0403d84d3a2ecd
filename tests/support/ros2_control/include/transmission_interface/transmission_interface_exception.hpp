#pragma once
#include <stdexcept>

namespace transmission_interface {
struct TransmissionInterfaceException : std::runtime_error {
    using std::runtime_error::runtime_error;
};
}  // namespace transmission_interface
