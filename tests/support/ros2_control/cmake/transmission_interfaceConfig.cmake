add_library(transmission_interface::transmission_interface INTERFACE IMPORTED)
target_include_directories(transmission_interface::transmission_interface INTERFACE "${CMAKE_CURRENT_LIST_DIR}/../include")
