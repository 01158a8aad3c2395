/* What is in the making under a temporary name, so that a program that is ended by a signal can remove it. */
#ifndef STYLUT_BASE_LEFTOVERS_H
#define STYLUT_BASE_LEFTOVERS_H

/* Creating, renaming or removing, and saying so, is one step: all of it happens between these two. Once a signal has
 * ended the program, nobody gets past the first. */
void sty_lock_leftovers(void);
void sty_unlock_leftovers(void);

/* Removes a folder of files. */
void sty_remove_folder(const char *path);

/* Between the two: a file or a folder (of files alone) that is in the making from now on, or no longer. Without memory
 * it isn't noted. */
void sty_note_leftover(const char *path);
void sty_forget_leftover(const char *path);

#endif
