# metier::beast: Boost.Beast, header-only, for HTTP messages and WebSockets. All that link it agree on
# Boost.Asio's memory: without the definition that of pending operations would come from
# std::aligned_alloc. A source file that includes it needs SKIP_UNITY_BUILD_INCLUSION: Boost.Asio
# and Asio cannot be in one unity source.

find_path(METIER_BOOST_INCLUDE boost/beast/websocket.hpp REQUIRED)
add_library(metier_beast INTERFACE)
add_library(metier::beast ALIAS metier_beast)
target_include_directories(metier_beast SYSTEM INTERFACE ${METIER_BOOST_INCLUDE})
target_compile_definitions(metier_beast INTERFACE BOOST_ASIO_DISABLE_STD_ALIGNED_ALLOC)
if(METIER_SANITIZE MATCHES thread)
    # Boost.Asio's atomic_thread_fence, which the thread sanitizer does not know.
    target_compile_options(metier_beast INTERFACE -Wno-tsan)
endif()
