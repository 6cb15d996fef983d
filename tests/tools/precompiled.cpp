// Nothing of its own: what precompiled.h is compiled for.
int main() {
    return 0;
}
