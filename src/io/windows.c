/* What Windows lacks of the functions of POSIX that posix.f90 calls; only compiled there. */
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <windows.h>

/* Files have the same bytes on every system: no carriage returns are added to lines. */
__attribute__((constructor)) static void bytes_as_they_are(void) {
  _fmode = _O_BINARY;
}

/* 0 on success; pipes and consoles cannot be written through, as in POSIX. */
int fsync(int descriptor) { return _commit(descriptor); }

struct asked {
  int descriptor;
  short asked, answered;
};

/* Always ready: reading and writing wait by themselves. */
int poll(struct asked *what, size_t count, int milliseconds) {
  (void)count;
  (void)milliseconds;
  what->answered = what->asked;
  return 1;
}

/* Symbolic links are followed by the system and not looked at. */
size_t readlink(const char *path, char *text, size_t length) {
  (void)path;
  (void)text;
  (void)length;
  errno = EINVAL;
  return (size_t)-1;
}

/* The whole path of an existing file, in at most 4096 characters and a zero byte. */
char *realpath(const char *path, char *whole) {
  if (_access(path, 0) != 0) return NULL;
  return _fullpath(whole, path, 4097);
}

/* Renames and replaces a file that has the new name, in one step. */
int rename(const char *from, const char *to) {
  return MoveFileExA(from, to, MOVEFILE_REPLACE_EXISTING) ? 0 : -1;
}
