/* The one place where volk's functions are compiled: it finds the Vulkan loader at run time. */
#define VOLK_IMPLEMENTATION
#include <volk.h>
