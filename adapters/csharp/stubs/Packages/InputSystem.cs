namespace UnityEngine.InputSystem
{
    public sealed class Mouse
    {
        public static Mouse current { get; set; }

        public Position position { get; } = new Position();

        public Button leftButton { get; } = new Button();
    }

    public sealed class Position
    {
        public Vector2 ReadValue()
        {
            return Vector2.zero;
        }
    }

    public sealed class Button
    {
        public bool isPressed
        {
            get { return false; }
        }
    }
}
