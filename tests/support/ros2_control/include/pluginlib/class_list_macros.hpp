// The class of a plugin, by its name in the library: what a class loader looks up.
#pragma once
#include <memory>
#include <string>

#define PLUGINLIB_EXPORT_CLASS(Class, Base)                                         \
    extern "C" Base *plugin(const char *type) {                                     \
        return std::string(type) == #Class ? std::make_unique<Class>().release() : nullptr; \
    }
