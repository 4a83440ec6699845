# sh by_clang.sh CLANG COMPILER ARGUMENTS...: the same by another compiler.
clang=$1
shift 2
exec "$clang" "$@"
