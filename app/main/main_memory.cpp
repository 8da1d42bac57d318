// The program's operator new: as the standard one, but it remembers what it could not give, for the error's
// sentence.
#include <cstdlib>
#include <new>

#include "engine/base/memory.h"

// Sanitizers bring their own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(GSE_SANITIZED)

void* operator new(std::size_t bytes) {
    while (true) {
        if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
        if (const auto handler = std::get_new_handler()) {
            handler();
            continue;
        }
        gse::note_refused(bytes);
        throw std::bad_alloc();
    }
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

#endif
