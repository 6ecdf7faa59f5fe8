"""Names that a robot cannot have, as it gives its name to C symbols, a C++ namespace and a library."""

_PREFIXES = "pg proxgen daqp qpoases casadi"

_KEYWORDS = """
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class
co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype
default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline
int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register
reinterpret_cast requires return short signed sizeof static static_assert static_cast std struct switch
template this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile
wchar_t while xor xor_eq linux unix
"""  # the last two are macros of compilers on Linux

_LIBRARIES = "c m dl rt util pthread gcc stdc"

RESERVED_NAMES = {
    **dict.fromkeys(_PREFIXES.split(), "is the prefix of other symbols in the library"),
    **dict.fromkeys(_KEYWORDS.split(), "is a word of C++, and would be the controller's namespace there"),
    **dict.fromkeys(_LIBRARIES.split(), "is the name of a library of the system"),
}
"""Why each name is taken."""
